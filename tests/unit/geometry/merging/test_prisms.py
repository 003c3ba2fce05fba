"""Whole prisms united on arrays, against the union of each prism by manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.geometry.merging.prisms import unite_prisms
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import count_edges
from amprep.model import DIRECTIONS

ORIGIN, SIZE = np.array([3.0, 5.0, 0.0]), np.array([2.0, 2.0, 1.5])

EDGES = st.lists(
    st.tuples(st.integers(0, 2), st.integers(1, 3), st.integers(1, 3), st.integers(0, 4)),
    min_size=1,
    max_size=16,
    unique=True,
)


def prisms(rows):
    """Prisms from (layer, y, x, direction)."""
    rows = np.array(sorted(rows), np.int64)
    return rows[:, 2::-1], np.array(DIRECTIONS, np.int64)[rows[:, 3]][:, ::-1]


def united(square, shift):
    from manifold3d import Manifold

    points, triangles = arrays_of(Manifold.cube([1.0, 1.0, 1.0]))
    solids = []
    for upper, step in zip(square, shift, strict=True):
        moved = points + upper
        moved[:, :2] += (1.0 - points[:, 2:]) * step
        solids.append(as_manifold(ORIGIN + moved * SIZE, triangles))
    return union(solids)


@given(EDGES)
def test_the_union_is_closed_and_has_the_volume_of_the_prisms_united_one_by_one(rows):
    square, shift = prisms(rows)
    points, triangles = unite_prisms(square, shift, ORIGIN, SIZE)
    _, counts, balance = count_edges(triangles)
    assert (counts == 2).all()
    assert (balance == 0).all()
    assert as_manifold(points, triangles).volume() == pytest.approx(united(square, shift).volume(), rel=1e-6)


@pytest.mark.parametrize("direction", range(5))
def test_one_prism_has_the_volume_and_the_box_of_its_shear(direction):
    square, shift = prisms([(0, 2, 2, direction)])
    points, triangles = unite_prisms(square, shift, ORIGIN, SIZE)
    assert as_manifold(points, triangles).volume() == pytest.approx(SIZE.prod())
    aside = np.append(np.abs(shift[0]), 0)
    assert np.ptp(points, axis=0) == pytest.approx(SIZE * (1 + aside))


def test_two_prisms_that_cross_share_a_quarter_of_a_cube():
    """Leaning to +x and to -x between the same two squares, they cross half way up in a prism of a quarter voxel."""
    square, shift = np.array([[1, 1, 0], [2, 1, 0]]), np.array([[1, 0], [-1, 0]])
    assert as_manifold(*unite_prisms(square, shift, ORIGIN, SIZE)).volume() == pytest.approx(
        1.5 * SIZE.prod()
    )


def test_the_same_prism_twice_is_one_prism():
    square, shift = prisms([(0, 2, 2, 1)])
    once, twice = (
        unite_prisms(np.repeat(square, n, axis=0), np.repeat(shift, n, axis=0), ORIGIN, SIZE) for n in (1, 2)
    )
    assert (once[0] == twice[0]).all()
    assert (once[1] == twice[1]).all()
