"""The distance that a body may travel, and the angle that it may turn, before it meets another one."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.annealing.engines import collide, travel, turn
from amprep.kernels.annealing.records import SKIN, AnnealingScene, AnnealingState, Shapes, Vector
from amprep.kernels.helper import uncounted

# Strategy. Only bodies whose axis-parallel boxes the moving box meets are asked (thesis 2.6). They are asked in the
# order in which the boxes meet, and each gets the least travel found so far as its upper bound, so most of them answer
# after a few pairs of nodes. The search ends when the bound is below what the move needs.


@uncounted
def _entry(box: Floats, other: Floats, direction: Vector, margin: float, limit: float) -> float:
    """Return the travel at which a moving box comes within a margin of another; infinity if not within the limit."""
    enter, leave = 0.0, limit
    for k in range(3):
        below, above = other[k] - margin - box[k + 3], other[k + 3] + margin - box[k]
        rate = direction[k]
        if abs(rate) <= 1e-14:
            if below >= 0.0 or above <= 0.0:
                return np.inf
        elif rate > 0.0:
            enter, leave = max(enter, below / rate), min(leave, above / rate)
        else:
            enter, leave = max(enter, above / rate), min(leave, below / rate)
    return enter if enter < leave else np.inf


@uncounted
def free_travel(
    shapes: Shapes,
    scene: AnnealingScene,
    state: AnnealingState,
    body: int,
    pose: Floats,
    box: Floats,
    direction: Vector,
    limit: float,
    needed: float,
) -> float:
    """Return how far a body at a pose may travel before it meets another one, at most `limit`, mm.

    A value below `needed` may be too large: the search ends there.
    """
    near, entry, count = state.near, state.entry, 0
    for other in range(scene.shape_of.size):
        if other == body:
            continue
        at = _entry(box, state.box[other], direction, min(scene.margin[body], scene.margin[other]), limit)
        if at < limit:
            k = count
            while k > 0 and entry[k - 1] > at:
                entry[k], near[k] = entry[k - 1], near[k - 1]
                k -= 1
            entry[k], near[k] = at, other
            count += 1
    best = limit
    for k in range(count):
        if entry[k] >= best or best < needed:
            break
        other = near[k]
        margin = min(scene.margin[body], scene.margin[other])
        best = min(
            best,
            travel(
                shapes,
                scene.shape_of[body],
                pose,
                scene.shape_of[other],
                state.pose[other],
                direction,
                margin,
                best,
            ),
        )
    return best


@uncounted
def free_turn(
    shapes: Shapes,
    scene: AnnealingScene,
    state: AnnealingState,
    body: int,
    point: Vector,
    axis: Vector,
    limit: float,
) -> float:
    """Return by which angle a body may turn about an axis before it meets another one, at most `limit`, rad."""
    shape, pose, radius = scene.shape_of[body], state.pose[body], 0.0
    for p in range(scene.first_point[shape], scene.first_point[shape + 1]):
        square = 0.0
        for k in range(3):
            at = pose[4 * k + 3] - point[k]
            for c in range(3):
                at += pose[4 * k + c] * scene.points[p, c]
            square += at * at
        radius = max(radius, square)
    radius, best = np.sqrt(radius), limit
    for other in range(scene.shape_of.size):
        margin = min(scene.margin[body], scene.margin[other])
        square = 0.0
        for k in range(3):
            gap = max(0.0, state.box[other, k] - point[k], point[k] - state.box[other, k + 3])
            square += gap * gap
        if other != body and best > 0.0 and square < (radius + margin) ** 2:
            best = min(
                best,
                turn(
                    shapes,
                    shape,
                    pose,
                    scene.shape_of[other],
                    state.pose[other],
                    point,
                    axis,
                    margin,
                    best,
                ),
            )
    return best


@uncounted
def column_top(scene: AnnealingScene, state: AnnealingState, body: int, box: Floats) -> float:
    """Return a height above which nothing blocks the fall of a body with this box, mm."""
    top = scene.low[2]
    for other in range(scene.shape_of.size):
        margin = min(scene.margin[body], scene.margin[other])
        if (
            other != body
            and state.box[other, 0] < box[3] + margin
            and state.box[other, 3] > box[0] - margin
            and state.box[other, 1] < box[4] + margin
            and state.box[other, 4] > box[1] - margin
        ):
            top = max(top, state.box[other, 5] + margin + 2.0 * SKIN)
    return top


@uncounted
def is_free(scene: AnnealingScene, state: AnnealingState, body: int, box: Floats) -> bool:
    """Return whether a box is apart from the boxes of all other bodies by their margins."""
    for other in range(scene.shape_of.size):
        margin = min(scene.margin[body], scene.margin[other])
        apart = other == body
        for k in range(3):
            apart = apart or box[k] >= state.box[other, k + 3] + margin
            apart = apart or box[k + 3] <= state.box[other, k] - margin
        if not apart:
            return False
    return True


@uncounted
def collisions(shapes: Shapes, scene: AnnealingScene, state: AnnealingState) -> int:
    """Return the number of pairs of bodies, at least one of them movable, that are closer than their margin."""
    count = 0
    for body in range(state.inside.size):
        for other in range(body + 1, scene.shape_of.size):
            margin = min(scene.margin[body], scene.margin[other])
            if _entry(state.box[body], state.box[other], (0.0, 0.0, 0.0), margin, 1.0) < 1.0 and collide(
                shapes,
                scene.shape_of[body],
                state.pose[body],
                scene.shape_of[other],
                state.pose[other],
                margin,
            ):
                count += 1
    return count
