"""Cells of all directions united on arrays, against the union of each cell by manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.geometry.merging.merge_cells import unite_cells
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.merging.voxel_contents import ContentsTable
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import degenerate, edges_match
from amprep.model import DIRECTIONS
from amprep.testing.random_lattice import barrel, random_layout

ORIGIN, SIZE = np.array([3.0, 5.0, 0.0]), np.array([2.0, 2.0, 1.5])


def box(lo, hi):
    from manifold3d import Manifold

    lo, hi = np.array(lo, float), np.array(hi, float)
    return arrays_of(Manifold.cube((hi - lo).tolist()).translate(lo.tolist()))


def joined(templates, template, square, shift):
    mesh = unite_cells(ContentsTable(templates), template, square, shift, ORIGIN, SIZE)
    assert mesh is not None
    assert edges_match(mesh[1])
    assert not degenerate(mesh[1]).any()
    return as_manifold(*mesh)


def united(templates, template, square, shift):
    """The union that takes so long: cell by cell."""
    solids = []
    for which, upper, step in zip(template, square, shift, strict=True):
        points, triangles = templates[which]
        moved = points + upper
        moved[:, :2] += (1.0 - points[:, 2:]) * step
        solids.append(as_manifold(ORIGIN + moved * SIZE, triangles))
    return union(solids)


def layout(rows, templates=1):
    """Cells from (layer, y, x, direction), each of some template."""
    rows = np.array(sorted(set(rows)), np.int64)
    shift = np.array(DIRECTIONS, np.int64)[rows[:, 3]][:, ::-1]
    return rows.sum(axis=1) % templates, rows[:, 2::-1], shift


ROWS = st.lists(
    st.tuples(st.integers(0, 2), st.integers(1, 3), st.integers(1, 3), st.integers(0, 4)),
    min_size=2,
    max_size=24,
)


def test_a_straight_and_an_oblique_cube_with_a_common_square_overlap_by_half():
    cube = [box((0, 0, 0), (1, 1, 1))]
    solid = joined(cube, *layout([(0, 1, 1, 0), (0, 1, 1, 1)]))
    assert solid.volume() == pytest.approx(1.5 * SIZE.prod())
    assert solid.genus() == 0


@given(ROWS)
@examples(25)
def test_junctions_of_random_cells_have_the_volume_and_genus_of_the_union(rows):
    cell = [barrel(5, 4)]
    ours, theirs = (make(cell, *layout(rows)) for make in (joined, united))
    assert ours.volume() == pytest.approx(theirs.volume(), rel=1e-6)
    assert ours.genus() == theirs.genus()


def test_cells_that_do_not_conform_are_united_side_by_side_and_one_upon_another():
    """Bars and plates that reach different sides of their cubes by different outlines."""
    cells = [
        box((0, 0.2, 0.25), (1, 0.8, 0.75)),
        box((0.15, 0, 0.35), (0.9, 1, 1)),
        box((0.25, 0.3, 0), (1, 0.7, 0.85)),
    ]
    rng = np.random.default_rng(5)
    for _ in range(5):
        which = layout(list(map(tuple, rng.integers([0, 1, 1, 0], [3, 4, 4, 5], (22, 4)))), templates=3)
        ours, theirs = joined(cells, *which), united(cells, *which)
        assert ours.volume() == pytest.approx(theirs.volume(), rel=1e-6)
        assert ours.genus() == theirs.genus()


def test_the_same_cells_give_the_same_mesh():
    which = random_layout(300, 0.2, seed=4)
    template = np.zeros(len(which.square), np.int64)
    first, second = (
        present(unite_cells(ContentsTable([barrel()]), template, which.square, which.shift, ORIGIN, SIZE))
        for _ in range(2)
    )
    assert (first[0] == second[0]).all()
    assert (first[1] == second[1]).all()
