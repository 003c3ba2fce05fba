"""Free travel of bodies upwards and downwards, with a clearance."""

from collections.abc import Sequence

import numpy as np

from amprep.geometry.removal.blocking import SETBACK, SLIDING
from amprep.geometry.removal.bodies import MovableBody
from amprep.geometry.trees.containment import solids_collide
from amprep.geometry.trees.queries import directional_distances

ROUNDING = 1e-4
"""mm by which bodies may be nearer than the clearance, because packers round as much."""


def vertical_travel(
    body: MovableBody, others: Sequence[MovableBody], sign: int, limit: float, margin: float
) -> float:
    """Return how far a body may travel upwards or downwards, mm, at most a limit.

    Bodies of boxes that are parallel to the axes keep the margin along each axis; all others keep it exactly.

    Parameters
    ----------
    body
        The body.
    others
        Bodies that keep their positions.
    sign
        1 for upwards, -1 for downwards.
    limit
        mm, at least 0.
    margin
        Least distance to other bodies, mm.
    """
    travel = limit
    for i in range(len(body.shapes)):
        for least, other, j in _ahead(body, i, others, sign, margin):
            if least >= travel:
                break
            if body.is_boxes and other.is_boxes:
                travel = least
            else:
                travel = min(travel, _exact(body, i, other, j, sign, margin, travel))
    return max(travel, 0.0)


def too_near(body: MovableBody, other: MovableBody, margin: float) -> bool:
    """Tell whether two bodies overlap or are nearer than a margin, but for `ROUNDING`."""
    reach = max(margin - ROUNDING, 0.0)
    for i, shape in enumerate(body.shapes):
        near = (body.low[i] < other.high + reach - ROUNDING) & (body.high[i] > other.low - reach + ROUNDING)
        for j in np.flatnonzero(near.all(axis=1)):
            if body.is_boxes and other.is_boxes:
                apart = np.maximum(np.maximum(body.low[i] - other.high[j], other.low[j] - body.high[i]), 0.0)
                if np.linalg.norm(apart) < reach or not apart.any():
                    return True
            elif solids_collide(shape.tree, other.shapes[j].tree, body.poses[i], other.poses[j], reach)[0]:
                return True
    return False


def _ahead(
    body: MovableBody, i: int, others: Sequence[MovableBody], sign: int, margin: float
) -> list[tuple[float, MovableBody, int]]:
    """Return the shapes whose boxes a shape may meet: the least travel until then, the body, and its number in that."""
    low, high = body.low[i], body.high[i]
    found = []
    for other in others:
        beside = (low[:2] < other.high[:, :2] + margin - SLIDING) & (
            high[:2] > other.low[:, :2] - margin + SLIDING
        )
        above, below = other.low[:, 2] - high[2], low[2] - other.high[:, 2]
        ahead, behind = (above, below) if sign > 0 else (below, above)
        met = np.flatnonzero(beside.all(axis=1) & (behind < -SLIDING))
        found += [(float(ahead[j]) - margin, other, int(j)) for j in met]
    return sorted(found, key=lambda each: each[0])


def _exact(
    body: MovableBody, i: int, other: MovableBody, j: int, sign: int, margin: float, limit: float
) -> float:
    """Return the travel of a shape until it is within the margin of another, from `SETBACK` behind its position."""
    direction = np.array([0.0, 0.0, float(sign)])
    pose = body.poses[i].copy()
    pose[2, 3] -= SETBACK * sign
    one, two = body.shapes[i].tree, other.shapes[j].tree
    found = directional_distances(one, two, pose, other.poses[j], direction, margin, limit + SETBACK)
    return float(found[0]) - SETBACK
