"""Bodies and the build volume: boxes around bodies, and how far a path stays between walls."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.annealing.records import CEILING, TOUCH, AnnealingScene, AnnealingState, Vector
from amprep.kernels.helper import uncounted


@uncounted
def enclose(scene: AnnealingScene, body: int, pose: Floats, box: Floats) -> None:
    """Write the axis-parallel box of a body at a pose."""
    shape = scene.shape_of[body]
    for k in range(3):
        low, high = np.inf, -np.inf
        for p in range(scene.first_point[shape], scene.first_point[shape + 1]):
            at = (
                pose[4 * k] * scene.points[p, 0]
                + pose[4 * k + 1] * scene.points[p, 1]
                + pose[4 * k + 2] * scene.points[p, 2]
            )
            low, high = min(low, at), max(high, at)
        box[k], box[k + 3] = low + pose[4 * k + 3], high + pose[4 * k + 3]


@uncounted
def is_inside(scene: AnnealingScene, ceiling: float, body: int, pose: Floats, box: Floats) -> bool:
    """Return whether a body is in the build volume, below the ceiling, up to `TOUCH`."""
    for k in range(3):
        high = ceiling if k == 2 else scene.high[k]
        if box[k] < scene.low[k] - TOUCH or box[k + 3] > high + TOUCH:
            return False
    if scene.is_flat and box[2] > scene.low[2] + TOUCH:
        return False
    return scene.radius == 0.0 or circle_travel(scene, body, pose, (1.0, 0.0, 0.0), 0.0) >= 0.0


@uncounted
def is_partly_inside(scene: AnnealingScene, box: Floats) -> bool:
    """Return whether the box of a body overlaps the build volume."""
    for k in range(3):  # noqa: SIM110 - numba compiles no generators
        if box[k] >= scene.high[k] or box[k + 3] <= scene.low[k]:
            return False
    return True


@uncounted
def wall_travel(
    box: Floats, low: Floats, high: Floats, ceiling: float, direction: Vector, limit: float
) -> float:
    """Return how far a box may travel between six walls, at most `limit`, mm; `ceiling` lowers the upper one."""
    best = limit
    for k in range(3):
        rate = direction[k]
        if rate > 1e-14:
            top = min(high[2], ceiling) if k == 2 else high[k]
            best = min(best, (top - box[k + 3]) / rate)
        elif rate < -1e-14:
            best = min(best, (low[k] - box[k]) / rate)
    return max(best, 0.0)


@uncounted
def circle_travel(scene: AnnealingScene, body: int, pose: Floats, direction: Vector, limit: float) -> float:
    """Return how far a body may travel in the cylinder, at most `limit`, mm; -1 if it is outside by more than TOUCH."""
    shape, best = scene.shape_of[body], limit
    x, y = 0.5 * (scene.low[0] + scene.high[0]), 0.5 * (scene.low[1] + scene.high[1])
    a = direction[0] * direction[0] + direction[1] * direction[1]
    for p in range(scene.first_point[shape], scene.first_point[shape + 1]):
        px, py, pz = scene.points[p, 0], scene.points[p, 1], scene.points[p, 2]
        dx = pose[0] * px + pose[1] * py + pose[2] * pz + pose[3] - x
        dy = pose[4] * px + pose[5] * py + pose[6] * pz + pose[7] - y
        over = np.sqrt(dx * dx + dy * dy) - scene.radius
        if over > TOUCH:
            return -1.0
        if a > 1e-28:
            b = dx * direction[0] + dy * direction[1]
            c = min(0.0, dx * dx + dy * dy - scene.radius * scene.radius)
            best = min(best, (np.sqrt(b * b - a * c) - b) / a)
    return max(best, 0.0)


@uncounted
def layout_top(scene: AnnealingScene, state: AnnealingState) -> float:
    """Return the greatest height of the bodies in the build volume, mm."""
    top = scene.low[2]
    for body in range(state.inside.size):
        if state.inside[body]:
            top = max(top, state.box[body, 5])
    return top


@uncounted
def classify(scene: AnnealingScene, state: AnnealingState) -> float:
    """Mark the movable bodies in the build volume below the ceiling; return the weight of the others."""
    outside = 0.0
    for body in range(state.inside.size):
        state.inside[body] = is_inside(scene, state.figures[CEILING], body, state.pose[body], state.box[body])
        if not state.inside[body]:
            outside += scene.weight[body]
    return outside
