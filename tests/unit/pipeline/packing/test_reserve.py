"""Packing leaves room beside the parts whose supports need it, and nothing else changes."""

import numpy as np
import pytest
from tests.shared.layouts import box, mesh_of

import amprep
from amprep.model import Part
from amprep.pipeline.packing.reserve import Reserve, has_room, with_room
from amprep.threemf import read_build

TABLE = box((20, 20, 3), (0, 0, 10)) + box((6, 6, 10), (7, 7, 0))
BLOCK_BELOW = box((20, 20, 4), (0, 0, 0)) + box((20, 20, 2), (0, 0, 30)) + box((20, 2, 32), (0, 18, 0))
"""The slab at the top hangs over a block on the plate: its supports can only stand beside the block."""


def packed(solid, packer="extreme-points", size=(120, 120, 60), copies=3, **settings):
    part = Part("part", mesh_of(solid), solid.volume(), quantity=copies)
    rules = {"supports": {"pitch_mm": 1.0, **settings}, "packing": {"lift_mm": 0.0, "clearance_mm": 4.0}}
    loaded = amprep.load(part, printer={"size_mm": list(size)}, settings=rules)
    return amprep.pack(loaded, packer=packer)


def distances(build):
    """The gaps between the boxes of each two parts, mm."""
    bounds = [placed.mesh.bounds for placed in build.parts]
    return [
        float(np.maximum(a[0] - b[1], b[0] - a[1])[:2].max())
        for i, a in enumerate(bounds)
        for b in bounds[:i]
    ]


def test_parts_whose_supports_stand_below_them_are_packed_as_ever():
    given, shared = packed(TABLE), packed(TABLE, territory="shared")
    assert given.notes == ()
    for one, other in zip(given.builds[0].parts, shared.builds[0].parts, strict=True):
        assert (one.matrix == other.matrix).all()
        assert one.part.overrides.territory_margin_mm is None


@pytest.mark.parametrize("packer", ["extreme-points", "plates"])
def test_parts_get_room_for_supports_that_stand_beside_them(packer):
    given = packed(BLOCK_BELOW, packer)
    (note,) = given.notes
    assert note.startswith("no other part may stand in the room that supports need beside parts: part ")
    (margin,) = {placed.part.overrides.territory_margin_mm for placed in given.builds[0].parts}
    assert margin > 2.0
    assert min(distances(given.builds[0])) >= 4.0 + 2.0 * (margin - 2.0) - 0.3
    assert f"{margin:.1f} mm" in note


def test_a_packing_has_room_exactly_if_it_is_one_of_the_wider_volumes():
    narrow, wide = packed(TABLE, copies=3), packed(BLOCK_BELOW)
    assert has_room(wide.problem, wide.packing)
    reserve = Reserve(9.0, 2.0, np.eye(3))
    _, wider = with_room([placed.part for placed in narrow.builds[0].parts[:1]], narrow.problem, {0: reserve})
    assert not has_room(wider, narrow.packing)


def test_with_room_more_red_squares_are_connected():
    every = {"contact_spacing_mm": 0.0}  # every red square is to be connected
    given = amprep.plan_supports(packed(BLOCK_BELOW, **every).builds[0])
    tight = amprep.plan_supports(packed(BLOCK_BELOW, size=(54, 54, 60), copies=4, **every).builds[0])
    count = [
        sum(int(layout.connected.sum()) / len(build.build.parts) for layout in build.layouts)
        for build in (given, tight)
    ]
    assert count[0] > count[1]


def test_parts_that_would_not_fit_with_room_are_packed_without_and_the_note_says_so():
    given = packed(BLOCK_BELOW, size=(54, 54, 60), copies=4)
    assert len(given.builds) == 1
    assert given.notes[0].startswith("supports need more room than there is beside parts")
    assert given.builds[0].parts[0].part.overrides.territory_margin_mm is None


@pytest.mark.parametrize("settings", [{"territory": "shared"}, {"enabled": False}])
def test_no_room_is_reserved_for_supports_that_may_be_anywhere_or_nowhere(settings):
    assert packed(BLOCK_BELOW, **settings).notes == ()


def test_the_margin_of_a_part_is_in_the_file_of_its_build(tmp_path):
    supported = amprep.emit_cells(amprep.plan_supports(packed(BLOCK_BELOW, copies=2).builds[0]))
    path = amprep.write(supported, tmp_path / "build.3mf")
    margins = {placed.part.overrides.territory_margin_mm for placed in read_build(path).parts}
    assert margins == {supported.build.parts[0].part.overrides.territory_margin_mm}
    assert amprep.verify(path).violations == ()
