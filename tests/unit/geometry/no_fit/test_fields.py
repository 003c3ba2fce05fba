"""Fields of depth against closed forms for boxes."""

import numpy as np
import pytest

from amprep.geometry.no_fit.fields import sample_fields
from amprep.geometry.no_fit.pieces import shape_set


def box(lo, hi):
    return np.array(
        [[x, y, z] for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])], float
    )


def fields_of(shapes, step, clearance=0.0):
    return sample_fields(shape_set(shapes, [], [clearance]), step, lambda: False)


def samples_of(fields, a, b):
    """The samples of a pair in their natural order, with the offsets of the grid along each axis."""
    n = fields.cells[a, b]
    flat = fields.values[fields.first[a, b] + fields.stride[a, b] * np.arange(8 * n.prod())]
    natural = flat.reshape(2, 2, 2, *n).transpose(3, 0, 4, 1, 5, 2).reshape(*(2 * n))
    return natural, [fields.origin[a, b, k] + fields.step * np.arange(2 * n[k]) for k in range(3)]


def box_depth(points, lo, hi):
    """Least distance of points to the sides of a box; negative outside, where it is that to the farthest plane."""
    x, y, z = points
    return np.min([x - lo[0], hi[0] - x, y - lo[1], hi[1] - y, z - lo[2], hi[2] - z], axis=0)


@pytest.mark.parametrize("step", [0.5, 0.7])
def test_the_depth_of_two_boxes_is_the_least_distance_to_a_side(step):
    fields = fields_of([[box((0, 0, 0), (2, 3, 4))], [box((0, 0, 0), (1, 1, 6))]], step)
    for a, b, lo, hi in ((1, 0, (-1, -1, -6), (2, 3, 4)), (0, 1, (-2, -3, -4), (1, 1, 6))):
        found, axes = samples_of(fields, a, b)
        exact = box_depth(np.meshgrid(*axes, indexing="ij"), lo, hi)
        near = exact > -1e-6
        assert np.abs(found - exact)[near].max() < 1e-5
        assert (found[~near] <= 1e-5).all()
        assert (found >= -2.0 * step - 1e-6).all()


def test_every_grid_contains_the_offset_zero_if_continued():
    fields = fields_of([[box((0, 0, 0), (2, 3, 4.4))]], 0.7, 0.3)
    steps = fields.origin[0, 0] / 0.7
    assert np.abs(steps - np.round(steps)).max() < 1e-9


def test_the_sign_of_a_union_tells_whether_shapes_of_several_boxes_overlap():
    shape = [((0, 0, 0), (3, 1, 1)), ((0, 0, 0), (1, 3, 1))]
    fields = fields_of([[box(*each) for each in shape]], 0.5)
    found, axes = samples_of(fields, 0, 0)
    x, y, z = np.meshgrid(*axes, indexing="ij")
    overlap = np.zeros(x.shape, bool)
    for lo, hi in shape:
        for other_lo, other_hi in shape:
            apart = [
                np.maximum(o + lo[k], other_lo[k]) >= np.minimum(o + hi[k], other_hi[k]) - 1e-9
                for k, o in enumerate((x, y, z))
            ]
            overlap |= ~np.any(apart, axis=0)
    assert ((found > 1e-5) == overlap).all()
    assert (found[overlap] <= np.minimum(3.0 - np.abs(x), 3.0 - np.abs(y))[overlap] + 1e-5).all()


def test_a_stop_ends_the_sampling():
    assert sample_fields(shape_set([[box((0, 0, 0), (1, 1, 1))]], [], [0.0]), 0.5, lambda: True) is None
