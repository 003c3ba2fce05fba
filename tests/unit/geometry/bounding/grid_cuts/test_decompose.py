"""Pieces contain the solid with its interior, and are exact where the solid has flat faces along the axes."""

import numpy as np
import pytest
from manifold3d import Manifold, OpType
from tests.shared.convex_solids import SOLIDS, part_of

from amprep.checks.volumes import check_volume
from amprep.geometry.bounding.convex.hulls import containing_hull
from amprep.geometry.bounding.grid_cuts.decompose import cut_solid
from amprep.geometry.bounding.grid_cuts.enclose import MOST_CORNERS
from amprep.model.bounding_volume import ConvexPieces
from amprep.model.mesh import Mesh


def never():
    return False


def decomposed(solid, count, stop=never):
    return cut(solid, stop).pieces(count, never)


def cut(solid, stop=never):
    vertices, triangles = part_of(solid).mesh.arrays
    return cut_solid(vertices, triangles, stop)


def union_of(pieces):
    return Manifold.batch_boolean([Manifold.hull_points(piece) for piece in pieces], OpType.Add)


CURVED = {
    "torus": lambda: Manifold.sphere(4, 32).translate([20, 0, 0]) + tube(20, 14, 6),
    "pin in a plate": lambda: (
        Manifold.cube([40, 30, 3]) + Manifold.cylinder(20, 4, 3, 48).translate([20, 12, 0])
    ),
    "turned bracket": lambda: (tube(15, 12, 30) - Manifold.cube([40, 40, 40])).rotate([31, 17, 50]),
    "spheres": lambda: Manifold.sphere(10, 40) + Manifold.sphere(7, 40).translate([13, 3, 2]),
    "comb": lambda: Manifold.cube([50, 10, 3]) + comb(),
}


def tube(outer, inner, height):
    return Manifold.cylinder(height, outer, outer, 48) - Manifold.cylinder(3 * height, inner, inner, 48, True)


def comb():
    teeth = [Manifold.cylinder(15, 1.5, 1, 24).translate([4 + 7 * k, 5, 0]) for k in range(7)]
    return Manifold.batch_boolean(teeth, OpType.Add)


@pytest.mark.parametrize("count", [1, 3, 12, 40])
@pytest.mark.parametrize("name", [*SOLIDS, *CURVED])
def test_the_pieces_contain_the_solid_with_its_interior(name, count):
    solid = (SOLIDS | CURVED)[name]()
    pieces = decomposed(solid, count)
    assert 1 <= len(pieces) <= count
    cover = ConvexPieces(tuple(Mesh(*containing_hull(piece)) for piece in pieces))
    assert check_volume(part_of(solid), cover) == []
    assert (solid - union_of(pieces)).volume() < 1e-7 * solid.volume()


@pytest.mark.parametrize(
    ("name", "count"), [("cube", 1), ("angle", 2), ("tee", 2), ("open box", 5), ("apart", 2), ("thin", 2)]
)
def test_a_solid_with_faces_along_the_axes_is_decomposed_exactly(name, count):
    solid = SOLIDS[name]()
    union = union_of(decomposed(solid, count)).volume()
    assert union == pytest.approx(solid.volume(), rel=1e-3 if name == "thin" else 1e-5)


def test_a_frame_is_decomposed_into_its_bars_although_no_plane_alone_saves_volume():
    frame = Manifold.cube([60, 50, 20]) - Manifold.cube([56, 46, 20]).translate([2, 2, 0])
    assert union_of(decomposed(frame, 4)).volume() == pytest.approx(frame.volume(), rel=1e-4)


@pytest.mark.parametrize("name", ["torus", "turned bracket", "spheres", "comb"])
def test_more_pieces_waste_less(name):
    solid = CURVED[name]()
    wasted = [union_of(decomposed(solid, count)).volume() / solid.volume() - 1 for count in (1, 6, 24)]
    assert wasted[0] > wasted[1] > wasted[2]


def test_a_ring_of_24_pieces_wastes_little_and_leaves_its_hole_free():
    ring = tube(20, 14, 6)
    union = union_of(decomposed(ring, 24))
    assert union.volume() < 1.12 * ring.volume()
    peg = Manifold.cylinder(6, 11, 11, 48)
    assert (union ^ peg).volume() == pytest.approx(0.0, abs=1e-6)


def test_a_closed_cavity_is_filled():
    hollow = Manifold.cube([20, 20, 20]) - Manifold.cube([12, 12, 12]).translate([4, 4, 4])
    assert union_of(decomposed(hollow, 12)).volume() == pytest.approx(8000.0, rel=1e-5)


def test_no_piece_has_many_corners():
    assert max(len(piece) for piece in decomposed(CURVED["spheres"](), 12)) <= MOST_CORNERS


def test_a_stop_before_the_first_cut_leaves_one_piece():
    (piece,) = decomposed(CURVED["torus"](), 12, stop=lambda: True)
    hull = CURVED["torus"]().hull()
    assert hull.volume() <= Manifold.hull_points(piece).volume() * (1 + 1e-6)


def test_a_stop_before_the_pieces_are_exact_returns_none():
    assert cut(CURVED["torus"]()).pieces(12, lambda: True) is None


def test_the_hulls_of_more_pieces_are_smaller_and_near_those_of_the_exact_pieces():
    solids = cut(CURVED["comb"]())
    for count in (1, 4, 8, 16):
        exact = sum(Manifold.hull_points(piece).volume() for piece in solids.pieces(count, never) or [])
        assert solids.hulls[count - 1] == pytest.approx(exact, rel=0.1)
    assert (np.diff(solids.hulls[:6]) < 0).all()
