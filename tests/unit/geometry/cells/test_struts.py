"""Struts and functions as solids in the unit cube: round in mm under any map, cut so that copies weld."""

from itertools import product

import numpy as np
import pytest

from amprep.geometry.cells.implicit import implicit_solid
from amprep.geometry.cells.ports import conform, flush_sides
from amprep.geometry.cells.struts import Graph, angles_deg, graph_solid
from amprep.geometry.cells.tiling import Tiles, tile
from amprep.geometry.meshes.manifold import as_manifold

PITCH = 2.0
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


def sheared(dx=0, dy=0, step=PITCH):
    linear = np.diag([PITCH, PITCH, step])
    linear[:2, 2] = -dx * PITCH, -dy * PITCH
    return linear


def tiled(arrays, linear, count=2):
    """The meshes that a block of copies becomes, and the block's volume in cubes."""
    place = np.array(list(product(range(count), repeat=3)))
    matrix = np.concatenate([np.tile(linear, (len(place), 1, 1)), (place @ linear.T)[:, :, None]], axis=2)
    return list(tile([arrays], Tiles(np.zeros(len(place), np.int64), place, matrix)))


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


def ball(points):
    """A ball in the middle of the cell and all its neighbours, touching them."""
    return 0.55 - np.linalg.norm(np.mod(points, 1.0) - 0.5, axis=1)


def test_a_function_is_meshed_up_to_the_sides_and_its_copies_weld():
    arrays = implicit_solid(ball, 20)
    cap = np.pi * 0.05**2 * (3 * 0.55 - 0.05) / 3
    assert as_manifold(*arrays).volume() == pytest.approx(4 / 3 * np.pi * 0.55**3 - 6 * cap, rel=0.01)
    assert len(tiled(arrays, sheared())) == 1


@pytest.mark.parametrize("wrong", [lambda points: points, lambda points: points[:, 0] * np.nan])
def test_a_function_that_gives_no_numbers_is_refused(wrong):
    with pytest.raises(ValueError, match="one finite number for each of"):
        implicit_solid(wrong, 8)


def box(lo, hi):
    from amprep.testing.problems import box_mesh

    mesh = box_mesh(np.array(lo, np.float64), np.array(hi, np.float64))
    return mesh.vertices, mesh.triangles.astype(np.int64)


def test_sides_cut_along_different_diagonals_are_made_the_same():
    points, triangles = box((0, 0, 0), (1, 1, 1))
    twisted = triangles.copy()
    twisted[2:4] = [[4, 5, 6], [5, 7, 6]]  # the other diagonal on top
    assert len(tiled((points, twisted), sheared())) == 2
    assert len(tiled(conform(points, twisted), sheared())) == 1


def test_a_corner_on_one_side_alone_is_put_onto_the_other_too():
    points, triangles = box((0, 0.25, 0), (1, 0.75, 1))
    points = np.vstack([points, [0.5, 0.25, 1.0]])  # in the middle of the edge 4-5
    split = [[4, 8, 7], [8, 5, 7], [0, 5, 8], [0, 8, 4]]
    keep = [row for row in triangles.tolist() if not {4, 5} <= set(row)]
    mesh = np.array(keep + split)
    assert as_manifold(points, mesh).volume() == pytest.approx(0.5)
    assert len(tiled((points, mesh), sheared())) == 2
    conforming = conform(points, mesh)
    assert len(tiled(conforming, sheared())) == 1
    assert as_manifold(*conforming).volume() == pytest.approx(0.5)


def test_six_digits_are_enough_to_lie_on_a_side():
    points, triangles = box((0.25, 0.25, 0), (0.75, 0.75, 1))
    rough = points + 4e-6 * np.sin(np.arange(24).reshape(8, 3))
    tidy, _ = conform(rough, triangles)
    assert set(tidy[:, 2].tolist()) == {0.0, 1.0}
    assert tidy[tidy[:, 2] == 0.0][:, :2].tolist() == tidy[tidy[:, 2] == 1.0][:, :2].tolist()
