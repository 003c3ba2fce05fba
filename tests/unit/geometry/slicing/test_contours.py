"""Contours of many planes at once are those that manifold3d cuts one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.solids import PRINTABLE, arrays, random_solid
from tests.shared.supported import box

from amprep.geometry.slicing.contours import SlicedMesh


def difference(a, b):
    return (a - b).area() + (b - a).area()


@given(st.integers(0, 10_000), st.floats(0.13, 0.9))
@examples(25)
def test_contours_enclose_the_slices_of_manifold3d(seed, step):
    solid = random_solid(seed)
    low, high = solid.bounding_box()[2], solid.bounding_box()[5]
    heights = np.arange(low + 0.4321 * step, high, step)
    contours = SlicedMesh(*arrays(solid)).contours(heights)
    for plane, height in enumerate(heights):
        own = np.flatnonzero(contours.plane == plane)
        expected = solid.slice(height)
        assert difference(contours.region_of(own), expected) < 1e-6
        assert contours.area[own].sum() == pytest.approx(expected.area(), abs=1e-6)


def test_a_plane_through_vertices_and_faces_cuts_below_them():
    steps = box((4, 4, 2), (0, 0, 0)) + box((2, 2, 2), (1, 1, 2))
    contours = SlicedMesh(*arrays(steps)).contours(np.array([0.0, 2.0, 4.0]))
    assert contours.plane.tolist() == [1, 2]
    assert contours.area == pytest.approx([16.0, 4.0])


def test_holes_are_negative_and_follow_their_borders_clockwise():
    contours = SlicedMesh(*arrays(PRINTABLE["nested balls"]())).contours(np.array([0.01]))
    x, y = contours.points_of(int(contours.area.argmin())).T
    shoelace = 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    assert contours.area.min() == pytest.approx(shoelace)
    assert shoelace < 0.0


@pytest.mark.parametrize("turn", [0, 30, 90, 200])
def test_bodies_that_touch_along_an_edge_have_contours_of_their_own(turn):
    posts = (box((1, 1, 9), (0, 0, 0)) + box((1, 1, 9), (1, 1, 0))).rotate((0, 0, turn))
    sliced = SlicedMesh(*arrays(posts))
    contours = sliced.contours(np.array([2.0, 5.0]))
    assert contours.area == pytest.approx([1.0] * 4)
    below, above = sliced.slabs(contours)
    assert len(set(above[contours.plane == 0])) == 2
    assert set(above[contours.plane == 0]) == set(below[contours.plane == 1])


def test_slabs_join_what_is_connected_between_planes():
    fork = box((10, 2, 4), (0, 0, 0)) + box((2, 2, 4), (0, 0, 4)) + box((2, 2, 4), (8, 0, 4))
    sliced = SlicedMesh(*arrays(fork))
    contours = sliced.contours(np.array([1.0, 5.0, 7.0]))
    below, above = sliced.slabs(contours)
    assert sorted(contours.plane.tolist()) == [0, 1, 1, 2, 2]
    assert below[contours.plane == 0].tolist() == [-1]
    assert (above[contours.plane == 2] == -1).all()
    assert set(below[contours.plane == 1]) == set(above[contours.plane == 0])
    assert len(set(above[contours.plane == 1])) == 2


def test_contours_of_an_open_mesh_end_at_its_border():
    vertices, triangles = arrays(Manifold.cube((2, 3, 4)))
    contours = SlicedMesh(vertices, triangles[:-1]).contours(np.array([1.0, 3.0]))
    assert sum(len(contours.points_of(c)) for c in range(len(contours.plane))) <= 16
    assert np.isfinite(contours.points).all()


def test_equal_vertices_are_merged_first():
    vertices, triangles = arrays(Manifold.sphere(5.0, 12))
    heights = np.array([-2.0, 0.1, 3.0])
    apart = SlicedMesh(vertices[triangles].reshape(-1, 3), np.arange(triangles.size).reshape(-1, 3))
    assert apart.contours(heights).area == pytest.approx(
        SlicedMesh(vertices, triangles).contours(heights).area
    )


def test_a_mesh_without_triangles_has_no_contours():
    sliced = SlicedMesh(np.empty((0, 3)), np.empty((0, 3), np.int64))
    contours = sliced.contours(np.array([1.0, 2.0]))
    assert len(contours.plane) == 0
    assert [len(found) for found in sliced.slabs(contours)] == [0, 0]


def test_edges_of_no_length_at_which_many_triangles_meet_are_no_obstacle():
    vertices, triangles = arrays(Manifold.cube((2, 3, 4)))
    collapsed = np.concatenate([triangles, [[0, 0, 1], [0, 0, 2], [0, 0, 3]]])
    contours = SlicedMesh(vertices, collapsed).contours(np.array([1.0]))
    assert contours.area.max() == pytest.approx(6.0)


@pytest.mark.parametrize("turn", [0, 20, 75])
@pytest.mark.parametrize("sizes", [(1.0, 0.5), (1.0, 0.5, 0.25), (0.5, 1.0, 2.0, 3.0)])
def test_overlapping_bodies_with_a_common_edge_have_closed_contours(sizes, turn):
    bodies = [
        arrays(box((size, size, 9), (0, 0, 0)).rotate((0, 0, turn * k))) for k, size in enumerate(sizes)
    ]
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in bodies)])
    vertices = np.concatenate([vertices for vertices, _ in bodies])
    triangles = np.concatenate([each + start for (_, each), start in zip(bodies, starts, strict=False)])
    sliced = SlicedMesh(vertices, triangles)
    assert (sliced.linked.twin >= 0).all()
    contours = sliced.contours(np.array([2.0, 5.0]))
    assert contours.area.sum() == pytest.approx(2.0 * sum(size**2 for size in sizes))
