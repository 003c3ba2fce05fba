"""Painted faces of a region become a region of their own, whose area is the painted area."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.builds import box_mesh
from tests.shared.examples import examples

from amprep.geometry.meshes.subdivision import subdivide
from amprep.model import Appearance, Mesh, Part, PlacedPart, Region
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import overhangs_of
from amprep.overhangs.paint import paint_of, split_by_paint

RED = "#ff0000"


def fine_slab():
    """A slab of 20 x 10 mm in the air with triangles of at most 1 mm."""
    slab = box_mesh((0, 0, 10), (20, 10, 2))
    found = subdivide(
        slab.vertices,
        slab.triangles,
        lambda corners, _: np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1) > 1.0,
    )
    return Mesh(found.vertices, found.triangles)


SLAB = fine_slab()
MIDDLE = SLAB.vertices[SLAB.triangles].mean(axis=1)
MOVE = np.array([[0.0, -1, 0, 50], [1, 0, 0, 5], [0, 0, 1, 3], [0, 0, 0, 1]])


def areas_below(chosen):
    corners = SLAB.vertices[SLAB.triangles]
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return double[chosen & (MIDDLE[:, 2] < 10.001)].sum() / 2


def regions_of(part, colour):
    placed = PlacedPart("p", part, MOVE)
    own = split_by_paint(placed, overhangs_of(placed, SupportRules()), {colour})
    paint = paint_of(placed, own, {colour})
    return own.overhangs, {bool(paint[i]): each for i, each in enumerate(own.overhangs.regions)}


def painted(chosen):
    colours = np.where(chosen[:, None], 0xFF0000FF, -1).repeat(3, axis=1)
    return Part("p", SLAB, 400.0, appearance=Appearance(triangle_colours=colours))


@given(x=st.floats(2, 18))
@examples(8)
def test_the_painted_half_of_a_face_is_a_region_of_its_own(x):
    chosen = MIDDLE[:, 0] < x
    found, regions = regions_of(painted(chosen), RED)
    assert regions[True].measure == pytest.approx(areas_below(chosen))
    assert regions[False].measure == pytest.approx(areas_below(~chosen))
    number = found.regions.index(regions[True])
    assert (found.face_region == number).sum() == (chosen & (MIDDLE[:, 2] < 10.001)).sum()


def test_a_face_of_one_colour_stays_one_region():
    everything = np.ones(len(MIDDLE), np.bool_)
    assert list(regions_of(painted(everything), RED)[1]) == [True]
    whole = Part("p", SLAB, 400.0, appearance=Appearance(colour="#FF0000FF"))
    assert list(regions_of(whole, RED)[1]) == [True]
    assert list(regions_of(whole, "#00ff00")[1]) == [False]


def test_a_marked_region_has_its_name_as_colour_in_all_three_forms():
    chosen = (MIDDLE[:, 0] < 10) & (MIDDLE[:, 2] < 10.001)
    triangles = np.flatnonzero(chosen).astype(np.int32)
    pieces = Mesh(SLAB.vertices, SLAB.triangles[triangles])
    forms = (
        Region("lattice", "rib", triangles),
        Region("lattice", "rib", triangles, pieces),
        Region("lattice", "rib", mesh=box_mesh((-1, -1, 9), (11, 12, 2))),
    )
    for form in forms:
        _, regions = regions_of(Part("p", SLAB, 400.0, regions=(form,)), "rib")
        assert regions[True].measure == pytest.approx(areas_below(chosen))
        assert regions[False].lowest_mm == pytest.approx(13.0)


def test_an_edge_is_painted_as_the_faces_at_it():
    roof = Mesh(
        [[0, 0, 8], [20, 0, 8], [0, -4, 14], [20, -4, 14], [0, 4, 14], [20, 4, 14]],
        [[0, 2, 1], [1, 2, 3], [0, 1, 4], [1, 5, 4], [2, 4, 3], [3, 4, 5], [0, 4, 2], [1, 3, 5]],
    )
    roof = Mesh(roof.vertices, roof.triangles[:, ::-1])
    red = np.full((8, 3), 0xFF0000FF)
    part = Part("p", roof, 480.0, appearance=Appearance(triangle_colours=red))
    placed = PlacedPart("p", part, np.eye(4))
    own = split_by_paint(placed, overhangs_of(placed, SupportRules()), {RED})
    assert [each.kind for each in own.overhangs.regions] == ["edge"]
    assert paint_of(placed, own, {RED}) == (frozenset({RED}),)
