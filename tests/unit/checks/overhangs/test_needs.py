"""What the part itself carries, as the judge sees it, on shapes with sizes known by construction."""

import manifold3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.solids import mesh_of

from amprep.checks.overhangs.needs import GRANT_MM, are_needed
from amprep.checks.overhangs.samples import KINDS, judged_overhangs
from amprep.checks.overhangs.starts import starts_in_air
from amprep.checks.overhangs.surface import surface_of
from amprep.model import Overrides, Part, PlacedPart, Region
from amprep.model.supports import SupportRules

Solid = manifold3d.Manifold
LIMITS = SupportRules(rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0, plate_mm=0.06)


def placed(solid, turn=0.0, **settings):
    solid = solid.rotate((0, 0, turn))
    return PlacedPart("p", Part("p", mesh_of(solid), solid.volume(), **settings), np.eye(4))


def needed_points(part, rules=LIMITS, kind=None, strict=False):
    """Points that need a contact, all or of one kind."""
    found = judged_overhangs(part, rules, 0.5)
    rows = np.arange(len(found.samples.points))
    rows = rows[are_needed(found, rules, rows, strict=strict)]
    own = slice(None) if kind is None else found.samples.kind[rows] == KINDS.index(kind)
    return found.samples.points[rows[own]]


def box(size, corner):
    return Solid.cube(size).translate(corner)


def ledge(length):
    """A block with a shelf."""
    return box((10, 20, 20), (0, 0, 0)) + box((10 + length, 20, 5), (0, 0, 10))


def bridge(span):
    """Two blocks with a beam across the gap."""
    return box((20 + span, 10, 20), (0, 0, 0)) - box((span, 20, 10), (10, -1, 0))


def bore(diameter, sides=48):
    """A block with a horizontal bore."""
    hole = Solid.cylinder(40, diameter / 2, diameter / 2, sides, True).rotate((90, 0, 0))
    return box((30, 20, 30), (-15, -10, 0)) - hole.translate((0, 0, 15))


turns = st.floats(0, 90)


@given(st.floats(0.2, 6.0), turns)
@examples(15)
def test_a_ledge_needs_contacts_exactly_if_it_is_longer_than_the_limit(length, turn):
    points = needed_points(placed(ledge(length), turn))
    if length > LIMITS.ledge_mm + 2 * GRANT_MM:
        assert len(points) > 0
        assert np.allclose(points[:, 2], 10)
    elif length <= LIMITS.ledge_mm:
        assert len(points) == 0


@given(st.floats(1.0, 10.0), turns)
@examples(15)
def test_a_bridge_needs_contacts_exactly_if_it_is_longer_than_the_limit(span, turn):
    points = needed_points(placed(bridge(span), turn))
    if span > LIMITS.bridge_mm + 2 * GRANT_MM:
        assert len(points) > 0
    elif span <= LIMITS.bridge_mm:
        assert len(points) == 0


@given(st.floats(2.0, 20.0), turns)
@examples(15)
def test_a_bore_needs_contacts_exactly_if_it_is_wider_than_the_limit(diameter, turn):
    points = needed_points(placed(bore(diameter), turn))
    if diameter > LIMITS.bore_mm * 1.02 + 3 * GRANT_MM:
        assert len(points) > 0
    elif diameter <= LIMITS.bore_mm:
        assert len(points) == 0


def test_within_a_long_ledge_only_what_is_beyond_the_limit_needs_contacts():
    points = needed_points(placed(ledge(6.0)))
    assert points[:, 0].min() == pytest.approx(11.1, abs=0.5)
    assert (points[:, 0] > 11.0).all()
    assert points[:, 0].max() == pytest.approx(16.0, abs=0.01)


def test_what_is_near_one_end_of_a_wide_bridge_is_carried_as_a_ledge():
    points = needed_points(placed(bridge(6.0)))
    assert (points[:, 0] > 11.0).all()
    assert (points[:, 0] < 15.0).all()


def test_a_hanging_block_needs_contacts_everywhere_however_small_it_is():
    arm = box((4, 0.8, 1), (10, 9, 15)) + box((0.3, 0.3, 2), (13.5, 9.2, 13.5))
    part = placed(box((10, 20, 20), (0, 0, 0)) + arm)
    points = needed_points(part)
    assert (np.abs(points[:, 2] - 13.5) < 1e-6).any()
    assert len(needed_points(part, strict=True)) >= len(points)


def test_a_drop_below_a_short_arm_needs_contacts():
    dip = box((0.5, 0.5, 5), (14, 9, 14.5)) + box((5, 0.5, 3), (10, 9, 15))
    assert (needed_points(placed(box((10, 20, 20), (0, 0, 0)) + dip))[:, 2] < 14.6).any()


@pytest.mark.parametrize(("depth", "starts"), [(0.03, False), (0.05, True)])
def test_a_dip_of_less_than_a_layer_is_no_start_in_the_air(depth, starts):
    dip = box((0.5, 0.5, 5), (14, 9, 15 - depth)) + box((5, 0.5, 3), (10, 9, 15))
    surface = surface_of(placed(box((10, 20, 20), (0, 0, 0)) + dip).mesh)
    assert starts_in_air(surface, 0.06, 0.04).any() == starts
    assert starts_in_air(surface, 0.06).any()


def test_flat_arches_of_the_width_of_a_bore_are_bridges():
    flat = box((30, 20, 30), (-15, -10, 0)) - box((4.0, 40, 10), (-2, -20, 5))
    assert len(needed_points(placed(flat))) > 0
    roof = Solid.cube((6, 40, 6), True).rotate((0, 30, 0)).translate((0, 0, 12))
    assert len(needed_points(placed(box((30, 20, 30), (-15, -10, 0)) - roof))) > 0


def test_a_gap_is_no_way_to_an_anchor():
    wall = box((3, 20, 20), (0, 0, 0))
    hook = box((8, 2, 3), (3, 0, 10)) + box((2, 10, 3), (9, 0, 10)) + box((6, 2, 3), (3.5, 8, 10))
    points = needed_points(placed(wall + hook))
    tip = (points[:, 0] < 4.0) & (points[:, 1] > 8.0)
    assert tip.any()


def test_turns_of_a_thread_do_not_carry_one_another():
    ramp = [box((4, 2.2, 1.0), (3, -1.1, 2 + 0.1 * k)).rotate((0, 0, 10.0 * k)) for k in range(72)]
    part = placed(Solid.batch_boolean([Solid.cylinder(20, 4, 4, 64), *ramp], manifold3d.OpType.Add))
    points = needed_points(part)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert (radius > 4.9).all()
    assert len(points) > 100


def test_what_is_within_a_layer_of_the_plate_is_on_it():
    feet = box((20, 20, 5), (0, 0, 0.05)) + box((2, 2, 2), (9, 9, 0))
    assert len(needed_points(placed(feet))) == 0
    higher = box((20, 20, 5), (0, 0, 0.2)) + box((2, 2, 2), (9, 9, 0))
    assert len(needed_points(placed(higher))) > 0


def test_a_ball_on_the_plate_is_carried_up_to_a_ledge_beyond_what_is_on_the_plate():
    points = needed_points(placed(Solid.sphere(15, 128).translate((0, 0, 15))))
    radius = np.hypot(points[:, 0], points[:, 1])
    assert 1.34 + 1.0 - 0.2 < radius.min() < 1.34 + 1.0 + 1.0
    assert radius.max() > 10.0


def test_the_angle_of_the_part_takes_precedence():
    part = placed(ledge(3.0), overrides=Overrides(overhang_angle_deg=0.0))
    assert len(needed_points(part)) == 0


def test_enforced_faces_need_contacts_although_the_part_carries_them():
    part = ledge(0.5)
    mesh = mesh_of(part)
    low = np.flatnonzero((mesh.vertices[mesh.triangles][:, :, 2] == 10).all(axis=1)).astype(np.int32)
    assert len(needed_points(placed(part))) == 0
    assert len(needed_points(placed(part, regions=(Region("enforcer", "e", low),)))) > 0


def prism_edge(length, both):
    """A triangular beam with a knife edge below, at one wall or between two."""
    beam = Solid.cube((length, 4, 4)).rotate((45, 0, 0)).translate((5, 5, 10))
    walls = box((5, 10, 20), (0, 0, 0))
    return beam + walls + (box((5, 10, 20), (5 + length, 0, 0)) if both else Solid())


@pytest.mark.parametrize(
    ("length", "both", "needs"),
    [(0.9, False, False), (1.5, False, True), (1.9, True, False), (3.0, True, True)],
)
def test_knife_edges_reach_as_far_as_ledges_and_bridges(length, both, needs):
    assert (len(needed_points(placed(prism_edge(length, both)), kind="edge")) > 0) == needs


def test_certainly_carried_and_certainly_needed_leave_a_margin_between_them():
    for length in (0.8, 1.04, 1.3):
        part = placed(ledge(length))
        surely_needed, maybe_needed = len(needed_points(part)), len(needed_points(part, strict=True))
        assert surely_needed <= maybe_needed
    assert len(needed_points(placed(ledge(1.0)), strict=True)) > 0
    assert len(needed_points(placed(ledge(1.0)))) == 0


def lifted(chamfer):
    """A block of 10 mm x 10 mm, 3 mm above the plate, with a chamfer of 30 degrees around its underside."""
    far, rise = 5 + chamfer, chamfer * np.tan(np.radians(30))
    corners = [(x * h, y * h, z) for h, z in ((5, 3), (far, 3 + rise)) for x in (-1, 1) for y in (-1, 1)]
    return Solid.hull_points(np.array(corners)) + box((2 * far, 2 * far, 5), (-far, -far, 3 + rise))


@pytest.mark.parametrize(("chamfer", "carried"), [(0.6, True), (2.0, False)])
def test_a_level_start_carries_the_chamfer_beside_it_and_needs_contacts_itself(chamfer, carried):
    points = needed_points(placed(lifted(chamfer)), kind="face")
    assert len(points[points[:, 2] == 3.0]) >= 400
    assert (points[:, 2].max() < 3.1) == carried


def test_of_a_bore_with_a_burr_only_the_burr_needs_contacts():
    base = [(x, y, 18.05) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    points = needed_points(placed(bore(6.0) + Solid.hull_points(np.array([*base, (0.0, 0.0, 17.7)]))))
    assert len(points) > 0
    assert np.abs(points[:, :2]).max() < 1.2
