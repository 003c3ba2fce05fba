"""Boxes given by hand contain the part, or are rejected; the check of bounding volumes is exact."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.checks.volumes import check_volume
from amprep.errors import JobError
from amprep.model import Boxes, ConvexPieces, Mesh, Part, Solid
from amprep.plugins.volumes.given_boxes import enclosing_box, given_boxes


def mesh_of(solid):
    mesh = solid.to_mesh64()
    return Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def part(solid, **more):
    return Part("angle", mesh_of(solid), solid.volume(), **more)


def angle():
    """Return an angle bracket: a foot of 20 x 10 x 5 mm and a wall of 5 x 10 x 20 mm."""
    return Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20])


FOOT, WALL = [0, 0, 0, 20, 10, 5], [0, 0, 0, 5, 10, 20]


def boxes(*corners):
    array = np.array(corners, float)
    return Boxes(array[:, :3], array[:, 3:])


def test_the_enclosing_box_touches_the_part_on_all_six_sides():
    volume = enclosing_box(part(angle()))
    assert volume.lo.tolist() == [[0, 0, 0]]
    assert volume.hi.tolist() == [[20, 10, 20]]
    assert check_volume(part(angle()), volume) == []


def test_given_boxes_that_contain_the_part_are_accepted():
    volume = given_boxes(part(angle(), boxes=np.array([FOOT, WALL], float)))
    assert volume.hi.tolist() == [[20, 10, 5], [5, 10, 20]]


@pytest.mark.parametrize("given", [None, np.empty((0, 6))])
def test_missing_boxes_are_reported_with_the_key_to_add(given):
    with pytest.raises(JobError, match=r"'angle'.*needs boxes = .*found none"):
        given_boxes(part(angle(), boxes=given))


@pytest.mark.parametrize("bad", [[0, 0, 0, 20, 0, 5], [20, 10, 5, 0, 0, 0], [0, 0, 0, np.nan, 1, 1]])
def test_an_empty_box_is_rejected_with_its_number(bad):
    with pytest.raises(JobError, match="box 2 must be x0 < x1"):
        given_boxes(part(angle(), boxes=np.array([WALL, bad], float)))


def test_boxes_that_do_not_contain_the_part_are_rejected_with_the_location():
    with pytest.raises(
        JobError, match=r"does not contain 49.9 mm3 of the part, in the box \(19\.\d+, .*enlarge the boxes"
    ):
        given_boxes(part(angle(), boxes=np.array([[0, 0, 0, 19, 10, 5], WALL], float)))


def test_a_part_may_extend_beyond_its_boxes_by_the_tolerance():
    assert check_volume(part(angle()), boxes([0, 0, 0, 19.9995, 10, 5], WALL)) == []
    assert check_volume(part(angle()), boxes([0, 0, 0, 19.998, 10, 5], WALL)) != []
    assert check_volume(part(angle()), boxes([0, 0, 0, 19.9995, 10, 20])) == []
    assert check_volume(part(angle()), boxes([0, 0, 0, 19.998, 10, 20])) != []


def test_the_interior_of_a_solid_must_be_covered():
    # six plates that hold the whole surface of a cube leave its middle empty
    cube = part(Manifold.cube([10, 10, 10]))
    plates = [[0, 0, 0, 1, 10, 10], [9, 0, 0, 10, 10, 10], [0, 0, 0, 10, 1, 10], [0, 9, 0, 10, 10, 10]]
    plates += [[0, 0, 0, 10, 10, 1], [0, 0, 9, 10, 10, 10]]
    assert [v.promise for v in check_volume(cube, boxes(*plates))] == ["volume contains part"]
    assert check_volume(cube, boxes(*plates, [1, 1, 1, 9, 9, 9])) == []


def test_convex_pieces_and_solids_are_checked():
    foot, wall = (mesh_of(Manifold.cube(size)) for size in ([20, 10, 5], [5, 10, 20]))
    assert check_volume(part(angle()), ConvexPieces((foot, wall))) == []
    assert check_volume(part(angle()), ConvexPieces((foot,))) != []
    assert check_volume(part(angle()), Solid(mesh_of(angle()))) == []
    assert check_volume(part(angle()), Solid(mesh_of(angle().scale([1, 1, 0.99])))) != []


def test_the_triangles_of_a_surface_must_be_covered():
    sheet = Mesh([[0, 0, 0], [10, 0, 0], [0, 10, 0]], [[0, 1, 2]])
    surface = Part("sheet", sheet, 0.0, is_solid=False)
    assert check_volume(surface, enclosing_box(surface)) == []
    # a triangle that lies in no single box, but in the two together, and one that pokes out between them
    assert check_volume(surface, boxes([0, 0, 0, 5, 10, 1], [5, 0, 0, 10, 5, 1])) == []
    assert check_volume(surface, boxes([0, 0, 0, 5, 10, 1], [6, 0, 0, 10, 5, 1])) != []
