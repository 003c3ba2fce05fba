"""Positions to which a body can be let down from above, beside and on others."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.removal.bodies import MovableBody
from amprep.geometry.trees.queries import directional_distances

ABOVE = 1.0
"""mm above all others, at which a body begins its way down."""

DOWN = np.array([0.0, 0.0, -1.0])


def box_drops(
    body: MovableBody, others: Sequence[MovableBody], offsets: Floats, floor: float, margin: float
) -> Floats:
    """Return the heights at which a body comes to rest when only boxes of shapes count, ``(n,)`` mm.

    They are at least those of `drop`; the parameters are the same, for ``(n, 2)`` offsets.
    """
    low, high = _boxes(others)
    rest = np.full(len(offsets), floor - body.low[:, 2].min())
    for own_low, own_high in zip(body.low, body.high, strict=True):
        below = (
            (own_low[:2] + offsets[:, None] < high[:, :2] + margin)
            & (own_high[:2] + offsets[:, None] > low[:, :2] - margin)
        ).all(axis=2)
        tops = np.where(below, high[:, 2] + margin, -np.inf).max(axis=1, initial=-np.inf)
        rest = np.maximum(rest, tops - own_low[2])
    return rest


def drop(
    body: MovableBody, others: Sequence[MovableBody], offset: Floats, floor: float, margin: float
) -> float:
    """Return the height offset at which a body comes to rest that is let down from above all others, mm.

    Parameters
    ----------
    body
        The body at the offset (0, 0, 0).
    others
        Bodies that keep their positions.
    offset
        ``(2,)`` mm along x and y.
    floor
        Height below which no point of the body may be, mm.
    margin
        Least distance to other bodies, mm.
    """
    _, high = _boxes(others)
    start = max(float(high[:, 2].max(initial=floor)), floor) + margin + ABOVE - float(body.low[:, 2].min())
    travel = start - (floor - float(body.low[:, 2].min()))
    shift = np.array([*offset, start])
    for shape, pose, low, high_corner in zip(body.shapes, body.poses, body.low, body.high, strict=True):
        moved = pose.copy()
        moved[:3, 3] += shift
        for other in others:
            near = (low[:2] + offset < other.high[:, :2] + margin) & (
                high_corner[:2] + offset > other.low[:, :2] - margin
            )
            for j in np.flatnonzero(near.all(axis=1)):
                found = directional_distances(
                    shape.tree, other.shapes[j].tree, moved, other.poses[j], DOWN, margin, max(travel, 0.0)
                )
                travel = min(travel, float(found[0]))
    return start - travel


def _boxes(others: Sequence[MovableBody]) -> tuple[Floats, Floats]:
    """Return the corners ``(k, 3)`` of the boxes of all shapes."""
    empty = np.empty((0, 3))
    return (
        np.concatenate([empty, *(other.low for other in others)]),
        np.concatenate([empty, *(other.high for other in others)]),
    )
