"""The moves of the annealing: translation, re-insertion and rotation; each is decided before it is computed."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.annealing.paths import column_top, free_travel, free_turn, is_free
from amprep.kernels.annealing.records import (
    ABOUT_Z,
    CEILING,
    FREE,
    LISTED,
    SKIN,
    TOUCH,
    AnnealingRules,
    AnnealingScene,
    AnnealingState,
    Shapes,
    Vector,
)
from amprep.kernels.annealing.space import circle_travel, enclose, is_inside, is_partly_inside, wall_travel
from amprep.kernels.helper import uncounted
from amprep.kernels.random_numbers import uniform

# Strategy. The thesis decides first whether a body may leave the build volume, because a path is expensive. The same is
# done for heights: the random number of the Metropolis rule is drawn first and gives the greatest height at which the
# move would be accepted. A path that must end lower is cut there, or given up as soon as it is known to end higher.


@uncounted
def _random_direction(state: AnnealingState, is_flat: bool) -> Vector:
    """Return a uniformly random unit vector, horizontal if `is_flat`."""
    z = 0.0 if is_flat else 2.0 * uniform(state.random) - 1.0
    angle, across = 2.0 * np.pi * uniform(state.random), np.sqrt(1.0 - z * z)
    return across * np.cos(angle), across * np.sin(angle), z


@uncounted
def _inward_direction(scene: AnnealingScene, state: AnnealingState, body: int) -> Vector:
    """Return the direction from the centre of a body to a random point of the build volume."""
    x = scene.low[0] + uniform(state.random) * (scene.high[0] - scene.low[0])
    y = scene.low[1] + uniform(state.random) * (scene.high[1] - scene.low[1])
    z = scene.low[2] + uniform(state.random) * (scene.high[2] - scene.low[2])
    box = state.box[body]
    x, y, z = x - 0.5 * (box[0] + box[3]), y - 0.5 * (box[1] + box[4]), z - 0.5 * (box[2] + box[5])
    z = 0.0 if scene.is_flat else z
    length = np.sqrt(x * x + y * y + z * z)
    if length < 1e-9:
        return 1.0, 0.0, 0.0
    return x / length, y / length, z / length


@uncounted
def _sinking_direction(state: AnnealingState) -> Vector:
    """Return a direction downwards: the vertical in half of the cases, else one beside it."""
    if uniform(state.random) < 0.5:
        return 0.0, 0.0, -1.0
    x, y, z = _random_direction(state, False)
    return x, y, -abs(z)


@uncounted
def _highest_middle(scene: AnnealingScene, state: AnnealingState, body: int, temperature: float) -> float:
    """Return the height of the middle of a body that the Metropolis rule accepts at a random number, mm.

    The energy of a body is its mass times the square of that height, in units of the ceiling: high bodies are pressed
    down, low ones are free.
    """
    energy = -temperature * np.log(1.0 - uniform(state.random)) / max(scene.mass[body], 1e-12)
    height = state.figures[CEILING] - scene.low[2]
    middle = 0.5 * (state.box[body, 2] + state.box[body, 5]) - scene.low[2]
    return scene.low[2] + np.sqrt(middle * middle + energy * height * height)


@uncounted
def translate(
    shapes: Shapes,
    scene: AnnealingScene,
    state: AnnealingState,
    rules: AnnealingRules,
    body: int,
    may_leave: bool,
    temperature: float,
) -> bool:
    """Try a translation (thesis 2.6); if it is accepted, write it to `state.trial` and return True."""
    box, pose, ceiling = state.box[body], state.pose[body], state.figures[CEILING]
    fraction, stays = temperature / rules.hot, state.inside[body] and not may_leave
    sinks = state.inside[body] and not may_leave and uniform(state.random) < rules.sinks
    if sinks and not scene.is_flat:
        direction = _sinking_direction(state)
    elif not state.inside[body] and uniform(state.random) > fraction:
        direction = _inward_direction(scene, state, body)
    else:
        direction = _random_direction(state, scene.is_flat)
    limit = wall_travel(
        box, scene.hall_low, scene.hall_high, np.inf, direction, np.inf if sinks else rules.reach
    )
    if stays:
        limit = wall_travel(box, scene.low, scene.high, ceiling, direction, limit)
        if scene.radius > 0.0:
            limit = circle_travel(scene, body, pose, direction, limit)
        if direction[2] > 0.0:
            rise = _highest_middle(scene, state, body, temperature) - 0.5 * (box[2] + box[5])
            limit = min(limit, rise / direction[2])
    if limit <= SKIN:
        return False
    most = free_travel(shapes, scene, state, body, pose, box, direction, limit, SKIN)
    most = most - SKIN if most < limit else most
    distance = most if sinks else most * uniform(state.random)
    if distance <= SKIN:
        return False
    for k in range(12):
        state.trial[k] = pose[k]
    for k in range(3):
        state.trial[4 * k + 3] += distance * direction[k]
        state.trial_box[k] = box[k] + distance * direction[k]
        state.trial_box[k + 3] = box[k + 3] + distance * direction[k]
    if stays or is_partly_inside(scene, box) != state.inside[body]:
        return True
    becomes = is_inside(scene, ceiling, body, state.trial, state.trial_box)
    return becomes or not is_partly_inside(scene, state.trial_box) or uniform(state.random) < fraction


@uncounted
def _choose_rotation(scene: AnnealingScene, state: AnnealingState, body: int) -> None:
    """Write a rotation that the body may have, and no translation, to `state.trial`."""
    first, last, trial = scene.first_turn[body], scene.first_turn[body + 1], state.trial
    for k in range(12):
        trial[k] = 0.0 if k % 4 == 3 else state.pose[body, k]
    chance = uniform(state.random)
    if chance < 0.4:
        return
    if scene.freedom[body] == LISTED or chance < 0.8:
        row = first + int(uniform(state.random) * (last - first))
        for k in range(9):
            trial[4 * (k // 3) + k % 3] = scene.turns[row, k]
    elif scene.freedom[body] == ABOUT_Z:
        angle = 2.0 * np.pi * uniform(state.random)
        c, s = np.cos(angle), np.sin(angle)
        trial[0], trial[1], trial[2] = c, -s, 0.0
        trial[4], trial[5], trial[6] = s, c, 0.0
        trial[8], trial[9], trial[10] = 0.0, 0.0, 1.0
    else:
        _random_rotation(state)


@uncounted
def _random_rotation(state: AnnealingState) -> None:
    """Write a uniformly random rotation to `state.trial` (Shoemake 1992, from a unit quaternion)."""
    u, trial = uniform(state.random), state.trial
    s, t = 2.0 * np.pi * uniform(state.random), 2.0 * np.pi * uniform(state.random)
    x, y = np.sqrt(1.0 - u) * np.sin(s), np.sqrt(1.0 - u) * np.cos(s)
    z, w = np.sqrt(u) * np.sin(t), np.sqrt(u) * np.cos(t)
    trial[0], trial[1], trial[2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)
    trial[4], trial[5], trial[6] = 2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
    trial[8], trial[9], trial[10] = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)


@uncounted
def _shift(pose: Floats, box: Floats, axis: int, distance: float) -> None:
    pose[4 * axis + 3] += distance
    box[axis] += distance
    box[axis + 3] += distance


@uncounted
def _choose_coordinate(
    scene: AnnealingScene, state: AnnealingState, body: int, axis: int, size: float, least: float, most: float
) -> float:
    """Return a coordinate for the lower side of a box: at a wall, beside or in line with a body, or anywhere."""
    chance = uniform(state.random)
    if chance < 0.2:
        return least + uniform(state.random) * (most - least)
    if chance < 0.4:
        return least if uniform(state.random) < 0.5 else most
    other = int(uniform(state.random) * scene.shape_of.size)
    if other == body:
        return least
    gap = min(scene.margin[body], scene.margin[other]) + SKIN
    if chance < 0.7:
        return state.box[other, axis + 3] + gap
    if chance < 0.9:
        return state.box[other, axis] - gap - size
    return state.box[other, axis]


@uncounted
def reinsert(
    shapes: Shapes,
    scene: AnnealingScene,
    state: AnnealingState,
    body: int,
    may_leave: bool,
    temperature: float,
) -> bool:
    """Try to take a body out and to let it down from above at a random place, in an orientation that it may have.

    A body that may leave the build volume goes to its berth instead. If the move is accepted, it is written to
    `state.trial`, and True is returned.
    """
    trial, box, ceiling = state.trial, state.trial_box, state.figures[CEILING]
    if state.inside[body] and may_leave:
        for k in range(12):
            trial[k] = scene.berth[body, k]
        enclose(scene, body, trial, box)
        return is_free(scene, state, body, box)
    _choose_rotation(scene, state, body)
    enclose(scene, body, trial, box)
    for k in range(2):
        least, most = scene.low[k], scene.high[k] - (box[k + 3] - box[k])
        if most < least - TOUCH:
            return False
        at = _choose_coordinate(scene, state, body, k, box[k + 3] - box[k], least, most)
        _shift(trial, box, k, max(least, min(at, most)) - box[k])
    height = box[5] - box[2]
    highest = ceiling - height
    if state.inside[body]:
        highest = min(highest, _highest_middle(scene, state, body, temperature) - 0.5 * height)
    highest = min(highest, scene.low[2]) if scene.is_flat else highest
    if highest < scene.low[2] - TOUCH or (
        scene.radius > 0.0 and circle_travel(scene, body, trial, (1.0, 0.0, 0.0), 0.0) < 0.0
    ):
        return False
    start = column_top(scene, state, body, box)
    _shift(trial, box, 2, start - box[2])
    limit, needed = start - scene.low[2], start - highest - TOUCH
    fall = limit
    if limit > 0.0:
        fall = free_travel(shapes, scene, state, body, trial, box, (0.0, 0.0, -1.0), limit, needed)
        fall = fall - SKIN if fall < limit else fall
    if fall < needed or fall < 0.0:
        return False
    _shift(trial, box, 2, -fall)
    return is_inside(scene, ceiling, body, trial, box)


@uncounted
def _rotate_trial(state: AnnealingState, body: int, point: Vector, axis: Vector, angle: float) -> None:
    """Write the pose of a body after a rotation to `state.trial` (Rodrigues' formula)."""
    c, s, pose = np.cos(angle), np.sin(angle), state.pose[body]
    for k in range(4):
        x, y, z = pose[k], pose[4 + k], pose[8 + k]
        if k == 3:
            x, y, z = x - point[0], y - point[1], z - point[2]
        along = (axis[0] * x + axis[1] * y + axis[2] * z) * (1.0 - c)
        state.trial[k] = c * x + s * (axis[1] * z - axis[2] * y) + along * axis[0]
        state.trial[4 + k] = c * y + s * (axis[2] * x - axis[0] * z) + along * axis[1]
        state.trial[8 + k] = c * z + s * (axis[0] * y - axis[1] * x) + along * axis[2]
    for k in range(3):
        state.trial[4 * k + 3] += point[k]


@uncounted
def rotate(
    shapes: Shapes,
    scene: AnnealingScene,
    state: AnnealingState,
    rules: AnnealingRules,
    body: int,
    may_leave: bool,
    temperature: float,
) -> bool:
    """Try a rotation about an axis through the centre of a body's box (thesis 2.6).

    If the rotation is accepted, it is written to `state.trial`, and True is returned.
    """
    box, freedom = state.box[body], scene.freedom[body]
    if freedom == LISTED or (freedom == FREE and scene.is_flat):
        return False
    axis = _random_direction(state, False) if freedom == FREE else (0.0, 0.0, 1.0)
    if uniform(state.random) < 0.5:
        axis = (-axis[0], -axis[1], -axis[2])
    point = (0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), 0.5 * (box[2] + box[5]))
    highest = _highest_middle(scene, state, body, temperature)
    wanted = rules.angle * uniform(state.random)
    most = free_turn(shapes, scene, state, body, point, axis, wanted)
    angle = most if most == wanted else most * uniform(state.random)
    if angle <= 1e-6:
        return False
    _rotate_trial(state, body, point, axis, angle)
    enclose(scene, body, state.trial, state.trial_box)
    for k in range(3):
        if state.trial_box[k] < scene.hall_low[k] or state.trial_box[k + 3] > scene.hall_high[k]:
            return False
    if not state.inside[body]:
        return True
    middle = 0.5 * (state.trial_box[2] + state.trial_box[5])
    becomes = is_inside(scene, state.figures[CEILING], body, state.trial, state.trial_box)
    return middle <= highest and (becomes or may_leave)
