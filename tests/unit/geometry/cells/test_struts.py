"""Graphs as solids in the unit cube: round in mm under any map, with copies that weld."""

from itertools import product

import numpy as np
import pytest
from tests.shared.cells import PITCH, sheared, tiled

from amprep.geometry.cells.ports import flush_sides
from amprep.geometry.cells.struts import Graph, angles_deg, graph_solid
from amprep.geometry.meshes.manifold import as_manifold

NO_WALLS = np.empty((0, 3), np.int64)


CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))


BCC = Graph(
    np.vstack([CORNERS, [0.5, 0.5, 0.5]]),
    np.array([[corner, 8] for corner in range(8)]),
    np.full((8, 2), 0.3),
    NO_WALLS,
    0.0,
)


PIN = Graph(np.array([[0.5, 0.5, 0], [0.5, 0.5, 1]]), np.array([[0, 1]]), np.full((1, 2), 0.4), NO_WALLS, 0.0)


def test_a_pin_has_the_volume_of_its_cylinder():
    volume = as_manifold(*graph_solid(PIN, sheared())).volume() * PITCH**3
    assert volume == pytest.approx(np.pi * 0.4**2 * PITCH)


@pytest.mark.parametrize("direction", [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_an_oblique_pin_keeps_its_radius_and_stands_in_equal_discs(direction):
    points, triangles = graph_solid(PIN, sheared(*direction))
    mapped = points @ sheared(*direction).T
    way = sheared(*direction) @ (PIN.points[1] - PIN.points[0])
    middle = np.abs(points[:, 2] - 0.5) < 0.5
    to = mapped - sheared(*direction) @ PIN.points[0]
    away = np.linalg.norm(np.cross(to, way / np.linalg.norm(way)), axis=1)
    # eight corners with the circle's area reach 1.05 radii; the balls at the ports reach 1.41 radii and a bit
    assert away[middle].max(initial=0.0) < 0.4 * 1.05 * np.sqrt(2) * 1.1
    for side in (4, 5):
        flush = points[triangles[flush_sides(points, triangles) == side]][:, :, :2]
        area = np.abs(np.linalg.det(flush[:, 1:] - flush[:, :1])).sum() / 2 * PITCH**2
        assert area == pytest.approx(np.pi * 0.4**2 * 2, rel=0.15)  # a disc as wide as the strut's cut


@pytest.mark.parametrize(
    ("graph", "direction"), [(BCC, (0, 0)), (PIN, (0, 0)), (PIN, (1, 0)), (PIN, (0, -1))]
)
def test_copies_weld_to_one_closed_mesh(graph, direction):
    arrays = graph_solid(graph, sheared(*direction))
    meshes = tiled(arrays, sheared(*direction))
    volume = as_manifold(*arrays).volume() * PITCH**3
    assert len(meshes) == 1
    assert as_manifold(*meshes[0]).volume() == pytest.approx(
        8 * volume, rel=1e-5
    )  # welding rounds to what files keep


def test_a_body_centred_cell_has_as_many_holes_as_its_graph():
    # 2 x 2 x 2 cells: 8 centres, 27 corners, 64 struts, one piece: 64 - 35 + 1 loops
    (mesh,) = tiled(graph_solid(BCC, sheared()), sheared())
    assert as_manifold(*mesh).genus() == 64 - 35 + 1


def test_walls_have_their_thickness():
    square = np.array([[0.5, 0, 0], [0.5, 1, 0], [0.5, 1, 1], [0.5, 0, 1]])
    wall = Graph(square, np.empty((0, 2), np.int64), np.empty((0, 2)), np.array([[0, 1, 2], [0, 2, 3]]), 0.3)
    assert as_manifold(*graph_solid(wall, sheared())).volume() == pytest.approx(0.15)


def test_steepness_is_measured_under_the_map():
    assert angles_deg(PIN.points, PIN.struts, sheared()) == pytest.approx([90.0])
    assert angles_deg(PIN.points, PIN.struts, sheared(1)) == pytest.approx([45.0])
    assert angles_deg(PIN.points, PIN.struts, sheared(1, step=PITCH * np.sqrt(3))) == pytest.approx([60.0])
