"""Texts on flat faces: inside the wall, within the face, and readable from outside."""

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from tests.shared.solids import mesh_of

from amprep.geometry.labels.faces import find_flat_faces
from amprep.geometry.labels.text_solid import (
    LEAST_STROKE_MM,
    OBSTRUCTED,
    TOO_SMALL,
    TOO_THIN,
    TextSize,
    write_on,
)

PLATE = Manifold.cube((40, 20, 6))


def written(solid, face, size):
    """The solid with the text, which the face holds."""
    made = write_on(solid, face, size)
    assert not isinstance(made, str)
    return made


def face(solid, name):
    return next(each for each in find_flat_faces(*mesh_of(solid).arrays) if each.looks(name))


def test_faces_that_look_down_or_aslant_are_left_out():
    wedge = Manifold.hull(Manifold.cube((20, 20, 2)) + Manifold.cube((20, 1, 10)))
    normals = [each.normal.round(6).tolist() for each in find_flat_faces(*mesh_of(wedge).arrays)]
    assert [0.0, 0.0, -1.0] not in normals
    assert all(z in (0.0, 1.0) for _, _, z in normals)


def test_the_largest_face_is_the_first_and_of_equal_ones_that_which_looks_up():
    faces = find_flat_faces(*mesh_of(Manifold.cube((10, 10, 10))).arrays)
    assert faces[0].normal.tolist() == [0.0, 0.0, 1.0]
    assert faces[1].normal.tolist() == [0.0, -1.0, 0.0]


@pytest.mark.parametrize("name", ["top", "front", "back", "left", "right"])
@pytest.mark.parametrize("depth", [0.5, -0.5])
def test_the_volume_of_a_stroke_is_that_of_a_rectangle_with_round_ends(name, depth):
    size = TextSize("-", 4.0, depth)
    made = written(Manifold.cube((20, 20, 20)), face(Manifold.cube((20, 20, 20)), name), size)
    length, width = 4.0 * 4.0 / 6.0, LEAST_STROKE_MM
    area = length * width + np.pi * (width / 2) ** 2
    assert made.volume() == pytest.approx(8000.0 - depth * area, rel=1e-5)
    low, high = np.split(np.array(made.bounding_box()), 2)
    assert (high - low).max() == pytest.approx(20.0 + max(-depth, 0.0))


def test_strokes_are_nowhere_thinner_than_promised():
    made = written(PLATE, face(PLATE, "top"), TextSize("AB/8", 4.0, 0.4))
    cut = CrossSection.square((40, 20)) - made.slice(5.8)
    assert cut.offset(-0.99 * LEAST_STROKE_MM / 2).area() > 0.0
    opened = cut.offset(-0.9 * LEAST_STROKE_MM / 2).offset(0.9 * LEAST_STROKE_MM / 2)
    assert (cut - opened).area() < 0.1


@pytest.mark.parametrize(
    ("name", "axis", "sign"), [("top", 0, 1), ("front", 0, 1), ("back", 0, -1), ("right", 1, 1)]
)
def test_a_text_reads_from_left_to_right_for_who_looks_at_the_face(name, axis, sign):
    """The letter L has its upright on the left: the wider half is at the bottom left."""
    cube = Manifold.cube((20, 20, 20))
    removed = cube - written(cube, face(cube, name), TextSize("L", 6.0, 0.4))
    points = mesh_of(removed).vertices - 10.0
    up = 1 if name == "top" else 2
    high = points[points[:, up] > 1.0]
    assert (sign * high[:, axis]).max() < 0.0, "only the upright is in the upper half"


def test_a_hole_in_the_middle_moves_the_text_aside():
    plate = PLATE - Manifold.cylinder(20, 4, 4, 32, True).translate((20, 10, 0))
    made = written(plate, face(plate, "top"), TextSize("AB", 4.0, 0.4))
    removed = mesh_of(plate - made).vertices
    assert np.hypot(removed[:, 0] - 20, removed[:, 1] - 10).min() > 4.0


def test_faces_that_hold_no_text_say_why():
    thin, size = Manifold.cube((40, 20, 0.75)), TextSize("AB", 4.0, 0.4)
    assert write_on(thin, face(thin, "top"), size) == TOO_THIN
    assert write_on(PLATE, face(PLATE, "top"), TextSize("ABCDEFGHIJKL", 4.0, 0.4)) == TOO_SMALL
    assert write_on(PLATE, face(PLATE, "top"), size, (17.0, 0.0)) == TOO_SMALL, "it would leave the face"
    slot = Manifold.cube((40, 20, 20)) - Manifold.cube((42, 22, 0.5)).translate((-1, -1, 10))
    slot += Manifold.cube((1, 20, 20))
    below = next(
        each for each in find_flat_faces(*mesh_of(slot).arrays) if each.looks("top") and each.frame[2, 3] < 15
    )
    assert write_on(slot, below, TextSize("AB", 4.0, -0.4)) == OBSTRUCTED


def test_a_wall_just_thick_enough_holds_an_engraved_text():
    enough = Manifold.cube((40, 20, 0.81))
    made = written(enough, face(enough, "top"), TextSize("AB", 4.0, 0.4))
    assert made.slice(0.2).area() == pytest.approx(800.0), "the wall behind is whole"


def test_on_a_turned_face_lines_run_upwards():
    narrow = Manifold.cube((6, 40, 6))
    assert write_on(narrow, face(narrow, "top"), TextSize("ABC", 4.0, 0.4)) == TOO_SMALL
    removed = narrow - written(narrow, face(narrow, "top").turned(), TextSize("L..", 4.0, 0.4))
    points = mesh_of(removed).vertices
    assert np.ptp(points[:, 1]) > 8.0
    assert np.ptp(points[:, 0]) < 5.0
    beginning = points[points[:, 1] < points[:, 1].min() + 0.4]
    assert np.ptp(beginning[:, 0]) > 3.5, "the upright of the L, which begins the line, is across it"
    assert points[points[:, 1] > points[:, 1].min() + 1.0][:, 0].min() > 4.0, (
        "its foot and the dots are on the right"
    )
