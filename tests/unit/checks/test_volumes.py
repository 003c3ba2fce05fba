"""The judge of volume makers accepts what contains a part, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.checks.volumes import check_volume
from amprep.model import Boxes, ConvexPieces, Mesh, Orientations, Part, Solid, TurnedVolume
from amprep.model.rotations import quarter_turns

BAR = Part("bar", box_mesh((0, 0, 0), (20, 10, 10)), 2000.0)
LEFT, RIGHT = box_mesh((0, 0, 0), (10, 10, 10)), box_mesh((10, 0, 0), (10, 10, 10))


@pytest.mark.parametrize(
    "volume",
    [
        Boxes([[0, 0, 0]], [[20, 10, 10]]),
        Boxes([[0, 0, 0], [10, 0, 0]], [[10, 10, 10], [20, 10, 10]]),
        ConvexPieces((LEFT, RIGHT)),
        Solid(BAR.mesh),
    ],
    ids=["box", "boxes", "pieces", "solid"],
)
def test_a_volume_that_contains_the_part_passes(volume):
    assert check_volume(BAR, volume) == []


@pytest.mark.parametrize("volume", [Boxes([[0, 0, 0]], [[19, 10, 10]]), ConvexPieces((LEFT,)), Solid(RIGHT)])
def test_a_volume_that_leaves_something_out_does_not(volume):
    (found,) = check_volume(BAR, volume)
    assert found.promise == "volume contains part"


def test_a_mesh_that_is_not_closed_bounds_nothing():
    (found,) = check_volume(BAR, Solid(Mesh(BAR.mesh.vertices, BAR.mesh.triangles[1:])))
    assert found.promise == "volume is closed"


def test_a_turned_volume_must_be_turned_as_the_part_allows():
    turn = quarter_turns()[1]
    upright = TurnedVolume(Boxes([[-10, 0, 0]], [[0, 20, 10]]), turn)
    (found,) = check_volume(BAR, upright)
    assert found.promise == "allowed motion"
    assert check_volume(BAR, TurnedVolume(Boxes([[0, 0, 0]], [[20, 10, 10]]), np.eye(3))) == []


def test_a_volume_that_its_maker_did_not_turn_passes_whatever_orientations_the_part_allows():
    part = replace(BAR, orientations=Orientations("list", quarter_turns()[1:2]))
    box = Boxes([[0, 0, 0]], [[20, 10, 10]])
    assert check_volume(part, TurnedVolume(box, np.eye(3))) == check_volume(part, box) == []
    (found,) = check_volume(part, TurnedVolume(box, quarter_turns()[2]))
    assert found.promise == "allowed motion"


def surface_of(mesh):
    return replace(BAR, mesh=Mesh(mesh.vertices, mesh.triangles[1:]), is_solid=False)


@pytest.mark.parametrize(
    "volume",
    [ConvexPieces((LEFT, RIGHT)), Solid(BAR.mesh), Boxes([[0, 0, 0], [10, 0, 0]], [[10] * 3, [20, 10, 10]])],
)
def test_the_triangles_of_a_surface_that_cross_from_piece_to_piece_are_contained(volume):
    assert check_volume(surface_of(BAR.mesh), volume) == []


@pytest.mark.parametrize(
    "volume",
    [
        ConvexPieces((LEFT,)),
        ConvexPieces((LEFT, box_mesh((10.01, 0, 0), (10, 10, 10)))),
        Solid(box_mesh((0, 0, 0), (20, 10, 9.99))),
        Boxes([[0, 0, 0], [10.01, 0, 0]], [[10] * 3, [20, 10, 10]]),
    ],
)
def test_a_triangle_of_a_surface_that_is_left_out_in_part_is_found(volume):
    (found,) = check_volume(surface_of(BAR.mesh), volume)
    assert found.promise == "volume contains part"
