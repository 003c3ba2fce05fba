"""Exact convex pieces against manifold3d: their union is the solid, and they do not overlap."""

import numpy as np
import pytest
import trimesh
from manifold3d import CrossSection, Manifold, OpType
from tests.shared.solids import arrays

from amprep.geometry.no_fit.partition import exact_pieces, hull_volume, winding_number


def pieces_of(vertices, triangles):
    return exact_pieces(vertices, triangles, lambda: False)


def tube():
    return Manifold.cube([4, 12, 14]) - Manifold.cube([10, 10, 12]).translate([-1, 1, 1])


def star():
    angle = np.arange(10) * np.pi / 5
    radius = np.where(np.arange(10) % 2, 1.5, 4.0)
    return Manifold.extrude(
        CrossSection([np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))]), 3.0
    )


def stairs():
    return Manifold.batch_boolean([Manifold.cube([4 - k, 3, 1 + k]) for k in range(4)], OpType.Add)


def cube():
    return Manifold.cube([1, 2, 3])


MOST_PIECES = {tube: 4, star: 10, stairs: 4, cube: 1}


@pytest.mark.parametrize(("make", "most"), MOST_PIECES.items())
def test_the_union_of_the_pieces_is_the_solid(make, most):
    solid = make()
    pieces = pieces_of(*arrays(solid))
    union = Manifold.batch_boolean([Manifold.hull_points(piece) for piece in pieces], OpType.Add)
    assert (union - solid).volume() + (solid - union).volume() < 1e-4 * solid.volume()
    assert sum(hull_volume(piece) for piece in pieces) == pytest.approx(solid.volume(), rel=1e-5)
    assert len(pieces) <= most


@pytest.mark.parametrize("edge", [0.4, 0.05])
def test_a_small_stud_on_a_large_part_is_in_the_pieces(edge):
    solid = Manifold.cube([100, 100, 100]) - Manifold.cube([30, 30, 30]).translate([10, 10, 80])
    solid += Manifold.cube([edge, edge, 2 * edge]).translate([50, 50, 100 - edge])
    union = Manifold.batch_boolean([Manifold.hull_points(p) for p in pieces_of(*arrays(solid))], OpType.Add)
    assert (solid - union).volume() < 0.01 * edge**3


def test_a_step_above_the_tolerance_of_contact_on_a_long_part_is_in_the_pieces():
    solid = Manifold.cube([400, 200, 10]) + Manifold.cube([200, 200, 10.002])
    union = Manifold.batch_boolean([Manifold.hull_points(p) for p in pieces_of(*arrays(solid))], OpType.Add)
    assert (solid - union).volume() < 200 * 200 * 0.001


def test_a_mesh_with_a_gap_is_decomposed_as_if_it_were_closed():
    vertices, triangles = arrays(stairs())
    pieces = pieces_of(vertices, triangles[1:])
    assert sum(hull_volume(piece) for piece in pieces) == pytest.approx(stairs().volume(), rel=1e-5)


def test_a_mesh_without_an_inside_has_no_pieces():
    sheet = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 1]])
    assert exact_pieces(sheet, np.array([[0, 1, 2]]), lambda: False) is None


def test_a_stop_ends_the_decomposition():
    vertices, triangles = arrays(star())
    assert exact_pieces(vertices, triangles, lambda: True) is None


def test_the_winding_number_is_one_inside_and_zero_outside():
    ball = trimesh.creation.icosphere(2)
    assert winding_number(ball.triangles, np.array([0.2, 0.1, -0.3])) == pytest.approx(1.0)
    assert winding_number(ball.triangles, np.array([0.2, 1.1, -0.3])) == pytest.approx(0.0, abs=1e-9)


def test_a_curved_mesh_that_needs_too_many_pieces_is_given_up():
    ball = Manifold.sphere(8, 12).rotate([10, 20, 30])
    solid = Manifold.sphere(10, 16) - ball.translate([5, 0, 0]) - ball.translate([-6, 3, 0])
    assert pieces_of(*arrays(solid)) is None


def test_the_bars_of_a_window_are_whole_although_planes_cut_them():
    window = Manifold.cube([30, 30, 2])
    for x in (2, 16):
        for y in (2, 16):
            window -= Manifold.cube([12, 12, 2]).translate([x, y, 0])
    assert len(pieces_of(*arrays(window))) <= 9
