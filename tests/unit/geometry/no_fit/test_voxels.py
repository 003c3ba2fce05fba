"""Fields from voxels against those of exact no-fit solids, and against closed forms for balls."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.geometry.no_fit.fields import sample_fields, samples
from amprep.geometry.no_fit.pieces import shape_set
from amprep.geometry.no_fit.voxels import sample_from_voxels


def box(lo, hi):
    return np.array(
        [[x, y, z] for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])], float
    )


def cloud(seed, n, size):
    return np.random.default_rng(seed).uniform(0.0, size, (n, 3))


CROSS = [
    box((0, 9, 9), (27, 13, 13)),
    box((9, 0, 9), (13, 27, 13)),
    box((9, 9, 0), (13, 13, 27)),
]
SHAPES = [CROSS, [cloud(1, 12, 15)], [cloud(2, 12, 9), cloud(3, 8, 20) + 5]]
OBSTACLE = [box((3, -4, 0), (33, 6, 100))]


def all_samples(fields, a, b):
    n = 8 * fields.cells[a, b].prod()
    return fields.scale * fields.values[fields.first[a, b] + fields.stride[a, b] * np.arange(n)].astype(float)


@pytest.mark.parametrize(("clearance", "step"), [(0.0, 1.5), (2.0, 1.5), (2.0, 2.5)])
def test_boundaries_are_where_they_are_in_exact_fields_but_for_a_fraction_of_a_step(clearance, step):
    shapes = shape_set(SHAPES, [OBSTACLE], [clearance, 0.0])
    exact = sample_fields(shapes, step, lambda: False)
    found = sample_from_voxels(shapes, step, lambda: False)
    for a, b in [(0, 0), (1, 0), (0, 1), (1, 1), (2, 1), (2, 2), (1, 3), (2, 3)]:
        depth, true = all_samples(found, a, b), all_samples(exact, a, b)
        near = np.abs(true) < step
        error = (depth - true)[near] / step
        assert np.abs(error).mean() < 0.35
        assert np.quantile(np.abs(error), 0.99) < 1.0
        assert ((depth > 0.0) == (true > 0.0))[np.abs(true) > step].all()


def test_the_depth_of_balls_is_the_sum_of_radii_and_clearance_less_the_distance():
    ball = np.asarray(Manifold.sphere(8.0, 24).to_mesh64().vert_properties[:, :3])
    step = 1.6
    fields = sample_from_voxels(shape_set([[ball]], [], [2.0]), step, lambda: False)
    assert fields is not None
    n = fields.cells[0, 0]
    natural = all_samples(fields, 0, 0).reshape(2, 2, 2, *n).transpose(3, 0, 4, 1, 5, 2).reshape(*(2 * n))
    axes = [fields.origin[0, 0, k] + step * np.arange(2 * n[k]) for k in range(3)]
    distance = np.sqrt(sum(x**2 for x in np.meshgrid(*axes, indexing="ij")))
    near = np.abs(18.0 - distance) < 1.5 * step
    assert np.abs(natural - 18.0 + distance)[near].mean() < 0.4 * step
    assert (natural[distance < 15.0] > 0.0).all()
    assert (natural[distance > 21.0] < 0.0).all()


def test_a_wall_thinner_than_a_voxel_is_not_lost():
    wall = [box((0, 0, 0), (20, 0.8, 20))]
    fields = sample_from_voxels(shape_set([wall], [], [0.0]), 2.5, lambda: False)
    assert (all_samples(fields, 0, 0) > 0.0).any()


def test_one_sample_takes_one_byte_and_the_mirrored_pair_takes_none():
    shapes = shape_set(SHAPES, [], [1.0])
    fields = sample_from_voxels(shapes, 2.0, lambda: False)
    assert fields is not None
    assert fields.values.nbytes == samples(shapes, 2.0)
    assert (all_samples(fields, 0, 1)[::-1] == all_samples(fields, 1, 0)).all()


def test_a_stop_ends_the_sampling():
    assert sample_from_voxels(shape_set(SHAPES, [], [1.0]), 2.0, lambda: True) is None
