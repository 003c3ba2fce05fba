"""Non-manifold edges of sets of cubes, against the theory of digital surfaces and the count of cubes."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage
from tests.shared.optional import present

from amprep.geometry.merging.nonmanifold_edges import (
    bisect_triangles,
    nonmanifold_vertices,
    split_nonmanifold_edges,
)
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import count_edges, merge_equal_vertices
from amprep.model import Mesh
from amprep.testing.problems import box_mesh

CUBE = box_mesh(np.zeros(3), np.ones(3))


def surface(filled):
    """The squares between filled and empty voxels, with one vertex at each corner of the grid."""
    points: list[tuple[int, ...]] = []
    triangles: list[list[int]] = []
    for voxel in np.argwhere(filled):
        for axis, end in product(range(3), (0, 1)):
            beside = voxel.copy()
            beside[axis] += 2 * end - 1
            inside = (beside >= 0).all() and (beside < filled.shape).all()
            if inside and filled[tuple(beside)]:
                continue
            flush = (CUBE.vertices[CUBE.triangles][:, :, axis] == end).all(axis=1)
            points.append(CUBE.vertices[CUBE.triangles[flush]].reshape(-1, 3) + voxel)
            triangles.append(np.arange(6).reshape(2, 3) + 6 * len(triangles))
    return merge_equal_vertices(np.concatenate(points), np.concatenate(triangles).astype(np.int64))


def sheets(triangles):
    """Count the sets of triangles that are connected over edges."""
    import networkx as nx

    graph = nx.Graph()
    first: dict[tuple[int, ...], int] = {}
    for index, corners in enumerate(triangles.tolist()):
        graph.add_node(index)
        for a, b in ((0, 1), (1, 2), (2, 0)):
            edge = frozenset((corners[a], corners[b]))
            graph.add_edge(index, first.setdefault(edge, index))
    return nx.number_connected_components(graph)


def digital_surfaces(filled):
    """Count the pairs of a solid, connected over faces, and a void, connected over edges, that touch in a face.

    Their common boundary is one connected surface (Udupa 1994, Graphical Models and Image Processing 56).
    """
    padded = np.pad(filled, 1)
    solid, _ = ndimage.label(padded)
    void, _ = ndimage.label(~padded, ndimage.generate_binary_structure(3, 2))
    pairs = set()
    for axis in range(3):
        low, high = np.moveaxis(solid, axis, 0), np.moveaxis(void, axis, 0)
        for inner, outer in ((low[1:], high[:-1]), (low[:-1], high[1:])):
            both = (inner > 0) & (outer > 0)
            pairs |= set(zip(inner[both].tolist(), outer[both].tolist(), strict=True))
    return len(pairs)


FILLED = st.lists(st.booleans(), min_size=27, max_size=27).filter(any)


@given(FILLED)
def test_no_edge_of_cubes_keeps_more_than_two_triangles_and_nothing_moves(flags):
    filled = np.array(flags).reshape(3, 3, 3)
    points, triangles = split_nonmanifold_edges(*surface(filled))
    _, counts, balance = count_edges(triangles)
    assert (counts == 2).all()
    assert (balance == 0).all()
    assert Mesh(points, triangles).signed_volume == pytest.approx(filled.sum())
    assert as_manifold(points, triangles).volume() == pytest.approx(filled.sum())


@given(FILLED)
def test_solids_that_touch_in_edges_become_separate_surfaces(flags):
    filled = np.array(flags).reshape(3, 3, 3)
    _, triangles = split_nonmanifold_edges(*surface(filled))
    assert sheets(triangles) == digital_surfaces(filled)


def test_two_cubes_with_a_common_edge_get_eight_vertices_each():
    points, triangles = surface(np.array([[[True], [False]], [[False], [True]]]))
    assert len(points) == 14
    on_the_edge = np.flatnonzero((points[:, :2] == 1).all(axis=1))
    assert present(nonmanifold_vertices(triangles)).tolist() == on_the_edge.tolist()
    points, triangles = split_nonmanifold_edges(points, triangles)
    assert (len(points), len(triangles), sheets(triangles)) == (16, 24, 2)


def test_cubes_around_an_edge_that_are_connected_elsewhere_get_a_vertex_in_the_middle_of_each_side():
    ring = np.ones((2, 2, 3), np.bool_)
    ring[0, 0, 1] = ring[1, 1, 1] = (
        False  # the edge in the middle layer has two solids, joined above and below
    )
    points, triangles = split_nonmanifold_edges(*surface(ring))
    _, counts, _ = count_edges(triangles)
    assert (counts == 2).all()
    middle = (points == (1.0, 1.0, 1.5)).all(axis=1)
    assert middle.sum() == 2


def test_an_open_mesh_comes_back_unchanged():
    triangles = CUBE.triangles[1:].astype(np.int64)
    assert nonmanifold_vertices(triangles) is None
    points, same = split_nonmanifold_edges(CUBE.vertices, triangles)
    assert points is CUBE.vertices
    assert same is triangles


@pytest.mark.parametrize("sides", list(product((False, True), repeat=3)))
def test_a_triangle_is_bisected_at_the_points_on_its_sides(sides):
    corners = np.array([[0.0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    middle = np.where(sides, [3, 4, 5], -1)[None]
    triangles = bisect_triangles(np.array([[0, 1, 2]]), middle)
    assert len(triangles) == 1 + sum(sides)
    edges = np.diff(corners[triangles], axis=1)
    areas = np.linalg.det(edges) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(0.5)
