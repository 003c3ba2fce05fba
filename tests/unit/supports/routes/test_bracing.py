"""Slenderness of supports, and struts that join slender columns."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.measures.slenderness import measure_slenderness
from amprep.model import Grid, Mesh, SupportBody, SupportEdges, Voxel
from amprep.supports.routes.bracing import add_cross_bracing


def test_slenderness_is_height_over_least_width_of_the_most_slender_piece():
    low, tall = box_mesh((0, 0, 0), (10, 10, 5)), box_mesh((30, 0, 0), (4, 2, 20))
    both = Mesh(
        np.concatenate([low.vertices, tall.vertices]),
        np.concatenate([low.triangles, tall.triangles + len(low.vertices)]),
    )
    columns = measure_slenderness(SupportBody("s", both, (0,)))
    assert columns.pieces == 2
    assert columns.slenderness == pytest.approx(10.0)
    assert columns.position_mm == pytest.approx((32, 1, 10))


def test_the_least_width_is_found_in_any_direction():
    turn = np.eye(4)
    turn[:2, :2] = [[np.sqrt(0.5), -np.sqrt(0.5)], [np.sqrt(0.5), np.sqrt(0.5)]]
    beam = box_mesh((0, 0, 0), (20, 2, 10)).moved(turn)
    assert measure_slenderness(SupportBody("s", beam, (0,))).width_mm == pytest.approx(2.0, rel=1e-4)


def test_voids_are_no_pieces():
    outer, inner = box_mesh((0, 0, 0), (10, 10, 20)), box_mesh((4, 4, 1), (0.5, 0.5, 18))
    hollow = Mesh(
        np.concatenate([outer.vertices, inner.vertices]),
        np.concatenate([outer.triangles, inner.triangles[:, ::-1] + len(outer.vertices)]),
    )
    columns = measure_slenderness(SupportBody("s", hollow, (0,)))
    assert columns.pieces == 1
    assert columns.slenderness == pytest.approx(2.0)


def column(y, x, height, part=0):
    return [[plane, y, x, 0, 1, 1, part] for plane in range(1, height + 1)]


def empty_grid(*closed, shape=(40, 9, 20)):
    voxels = np.full(shape, Voxel.FREE, np.uint8)
    for block in closed:
        voxels[block] = Voxel.CLOSED
    return Grid(np.zeros(3), 1.0, 1.0, shape), voxels


def pieces(edges):
    return int(edges.components(np.empty((0, 3), np.int32))[0].max()) + 1


def test_two_slender_columns_become_one_piece_by_struts_of_oblique_edges():
    edges = SupportEdges.from_rows(column(4, 3, 30) + column(4, 8, 30))
    grid, voxels = empty_grid()
    joined = add_cross_bracing(grid, voxels, edges, 8.0)
    assert (joined.braced, joined.alone) == (2, 0)
    assert (joined.edges.direction > 0).all()
    assert len(joined.edges) == 2 * 3 * 5, "each is braced at 8, 16 and 24 mm, five squares away"
    assert pieces(edges) == 2
    assert pieces(SupportEdges.concatenate([edges, joined.edges])) == 1


def test_struts_go_round_voxels_that_are_not_free_and_never_touch_other_parts_supports():
    edges = SupportEdges.from_rows(column(4, 3, 30) + column(4, 8, 30))
    grid, voxels = empty_grid((slice(None), slice(None), 5))
    assert add_cross_bracing(grid, voxels, edges, 8.0).alone == 2
    walls = SupportEdges.from_rows([row for y in range(9) for row in column(y, 5, 39, 1)])
    between = SupportEdges.concatenate([edges, walls])
    grid, voxels = empty_grid()
    found = add_cross_bracing(grid, voxels, between, 8.0)
    assert not (found.edges.part == 0).any()


def test_what_is_far_or_wide_stays_as_it_is():
    grid, voxels = empty_grid()
    far = SupportEdges.from_rows(column(4, 1, 30) + column(4, 18, 30))
    assert add_cross_bracing(grid, voxels, far, 8.0)[1:] == (0, 2)
    low = SupportEdges.from_rows(column(4, 3, 8) + column(4, 8, 8))
    assert add_cross_bracing(grid, voxels, low, 8.0)[1:] == (0, 0)


def test_struts_of_different_parts_share_no_voxel():
    edges = SupportEdges.from_rows(
        column(4, 3, 30) + column(4, 13, 30) + column(0, 8, 30, 1) + column(8, 8, 30, 1)
    )
    grid, voxels = empty_grid()
    joined = add_cross_bracing(grid, voxels, edges, 8.0)
    assert joined.braced == 4
    used = [set(joined.edges[joined.edges.part == part].voxel_parts()) for part in (0, 1)]
    assert not used[0] & used[1]
