"""Shapes made of boxes that stay parallel to the axes: closed forms (thesis 2.6)."""

# ruff: noqa: ARG001 - every engine takes the same arguments

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.annealing.records import TOUCH, Vector
from amprep.kernels.helper import uncounted

# Strategy. Two boxes within a margin overlap on an interval of travel: the intersection of three intervals, one for
# each axis. The margin is taken along each axis, which is exact but at edges and corners, where it is too much.


class BoxShapes(NamedTuple):
    """Boxes in the coordinates of their shapes.

    Attributes
    ----------
    centre, half
        ``(b, 3)`` mm, of all boxes, shape by shape.
    first
        ``(shapes + 1,)`` index of the first box of each shape.
    """

    centre: Floats
    half: Floats
    first: Int64s


@uncounted
def _placed(shapes: BoxShapes, box: int, pose: Floats, row: int) -> tuple[float, float]:
    """Return the centre and the half length of a box along an axis of the build, in a pose that maps axes to axes."""
    at, reach = pose[4 * row + 3], 0.0
    for k in range(3):
        at += pose[4 * row + k] * shapes.centre[box, k]
        reach += abs(pose[4 * row + k]) * shapes.half[box, k]
    return at, reach


@uncounted
def travel_of_boxes(
    shapes: BoxShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    direction: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return how far shape a may travel until it is within a margin of shape b, mm; see `engines.travel`."""
    best = limit
    for i in range(shapes.first[a], shapes.first[a + 1]):
        for j in range(shapes.first[b], shapes.first[b + 1]):
            enter, leave = 0.0, best
            for k in range(3):
                at, own = _placed(shapes, i, pose_a, k)
                other, reach = _placed(shapes, j, pose_b, k)
                gap, reach, rate = at - other, own + reach + margin - TOUCH, direction[k]
                if abs(rate) <= 1e-14:
                    if abs(gap) >= reach:
                        leave = -np.inf
                else:
                    enter = max(enter, -gap / rate - reach / abs(rate))
                    leave = min(leave, -gap / rate + reach / abs(rate))
            if enter < leave:
                best = min(best, enter)
    return best


@uncounted
def boxes_collide(shapes: BoxShapes, a: int, pose_a: Floats, b: int, pose_b: Floats, margin: float) -> bool:
    """Return whether two shapes are closer than a margin; see `engines.collide`."""
    for i in range(shapes.first[a], shapes.first[a + 1]):
        for j in range(shapes.first[b], shapes.first[b + 1]):
            apart = False
            for k in range(3):
                at, own = _placed(shapes, i, pose_a, k)
                other, reach = _placed(shapes, j, pose_b, k)
                apart = apart or abs(at - other) >= own + reach + margin - TOUCH
            if not apart:
                return True
    return False


@uncounted
def turn_of_boxes(
    shapes: BoxShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return 0: boxes that stay parallel to the axes turn by re-insertion only."""
    return 0.0
