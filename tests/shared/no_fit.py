"""Boxes as shapes for tests of the separation search."""

import numpy as np

from amprep.geometry.no_fit.fields import sample_fields
from amprep.geometry.no_fit.pieces import shape_set
from amprep.kernels.guided_search import MoveRules
from amprep.kernels.no_fit.records import PositionRange, SeparationState, ShapeLayout


def corners_of(size):
    return np.array([[x, y, z] for x in (0, size[0]) for y in (0, size[1]) for z in (0, size[2])], float)


def box_shapes(sizes, step, clearance=0.0):
    """Boxes with their least corners at the origin, as shapes, and the fields of their no-fit solids."""
    shapes = shape_set([[corners_of(size)] for size in sizes], [], [clearance])
    return shapes, sample_fields(shapes, step, lambda: False)


def in_box(sizes, room):
    """Positions of boxes in a room."""
    hi = np.array(room) - np.array(sizes, float)
    return PositionRange(np.zeros_like(hi), hi, 0.0, np.zeros(2), np.empty((0, 2)), np.zeros(1, np.int64))


def layout_of(shapes, positions):
    """All items in the build 0."""
    return ShapeLayout(np.array(shapes), np.zeros(len(shapes), np.int64), np.array(positions, float))


def boxes_overlap(sizes, layout, i, j):
    one, other = layout.position[i], layout.position[j]
    far, other_far = one + sizes[layout.shape[i]], other + sizes[layout.shape[j]]
    return bool((np.minimum(far, other_far) - np.maximum(one, other) > 1e-3).all())


def state_for(items, cells, seed=7):
    return SeparationState(
        overlap=np.zeros((items, items)),
        weight=np.ones((items, items)),
        outside=np.zeros(items),
        outside_weight=np.ones(items),
        touching=np.zeros(items, np.int64),
        pairs=np.empty((items * items, 2), np.int32),
        listed=np.zeros((items, items), bool),
        progress=np.array([0, -1]),
        least=np.full(1, np.inf),
        random=np.array([seed], np.uint64),
        spent=np.zeros(4, np.int64),
        sums=np.empty(cells, np.float32),
        near=np.empty((items, 5), np.int64),
        frame=np.empty((items, 4)),
        order=np.empty(items, np.int64),
        cell=np.empty(4, np.int64),
        value=np.empty(4),
    )


def rules_for(shapes, builds=1, ends=None):
    first = np.array(shapes)
    return MoveRules(first, first + 1 if ends is None else np.array(ends), builds, 0.5, 0.01, 1e-6)
