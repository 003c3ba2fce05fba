"""Tests of the finished solids of support groups."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Mesh
from amprep.supports.solids.drain_holes import cut_drain_holes
from amprep.supports.solids.thin_rests import heights_through, without_thin_rests
from amprep.supports.solids.unite_group import stored_solid

NO_FEET = np.empty((0, 3)), np.empty((0, 3))


def box(size, corner):
    return Manifold.cube(size).translate(corner)


def test_a_support_that_vanishes_is_no_error():
    part = box((5, 5, 5), (0, 0, 10)).to_mesh64()
    mesh = Mesh(np.array(part.vert_properties)[:, :3], np.array(part.tri_verts, np.int64))
    nothing, holes = cut_drain_holes(Manifold(), [mesh], 0.2, NO_FEET)
    assert len(holes[0]) == 0
    assert nothing.is_empty()
    assert stored_solid(nothing, None, NO_FEET) is None


def test_a_support_that_only_floats_is_not_written():
    assert stored_solid(box((1, 1, 1), (0, 0, 3)), None, NO_FEET) is None


def test_a_stored_solid_has_the_volume_of_the_union_and_can_be_read_again():
    ball = Manifold.sphere(5.0, 64).translate((7.1, 7.3, 5.0))
    base = box((9.1, 9.3, 0.7), (0.123456789, 0.2, 0.0))
    stored = stored_solid(ball, base, NO_FEET)
    assert stored is not None
    again = as_manifold(stored.vertices, stored.triangles)
    assert again.status().name == "NoError"
    assert again.volume() == pytest.approx((ball + base).volume(), rel=1e-5)


def test_what_a_drain_hole_leaves_thinner_than_the_least_wall_is_cut_away_with_it():
    """A hollow box traps powder, so that a hole leads through its wall."""
    hollow = box((6, 6, 6), (0, 0, 0)) - box((5, 5, 5), (0.5, 0.5, 0.5))
    opened, holes = cut_drain_holes(hollow, [], 0.4, NO_FEET)
    assert opened.volume() < hollow.volume()
    opened = without_thin_rests(opened, [], LeastSection(0.3, 0.0), 0.0, holes)
    assert all(
        not piece.offset(-0.14).is_empty()
        for height in np.arange(0.05, 6.0, 0.1)
        for piece in opened.slice(height).decompose()
    )


@pytest.mark.parametrize("seed", range(5))
def test_every_drain_hole_is_cut_by_one_of_the_chosen_heights(seed):
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, 10.0, 60)
    high = low + rng.uniform(0.1, 2.0, 60)
    heights = np.array(heights_through(low, high))
    assert ((low[:, None] < heights) & (heights < high[:, None])).any(axis=1).all()
    assert len(heights) < 60
