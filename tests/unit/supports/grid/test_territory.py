"""Territories of parts: which voxels their supports may use, and what becomes of red squares without a way there."""

import numpy as np
import pytest
from tests.shared.layouts import SPACE, box, layout, placed

from amprep.model import Mesh, Part, PlacedPart
from amprep.model.supports import ENCLOSED, TERRITORY
from amprep.supports.grid.red_squares import make_grid
from amprep.supports.grid.territory import find_territories
from amprep.supports.plan import PlanningRules

OWN = {"territory": "own", "drift_ratio": 1 / 3, "drift_mm": 15.0}
TABLE = box((20, 20, 3), (20, 20, 10)) + box((6, 6, 10), (27, 27, 0))
ROOF = box((12, 12, 2), (20, 20, 10)) + box((12, 2, 10), (20, 32, 0))
"""A slab that a wall at its back carries."""


def columns_in_use(plan, part=0):
    edges = plan.edges[plan.edges.part == part]
    x0, y0, _ = np.round(plan.grid.origin / plan.grid.pitch).astype(int)
    return {(y + y0, x + x0) for _, y, x in np.concatenate([edges.upper, edges.lower]).tolist()}


def test_shared_parts_have_no_territories():
    assert layout(placed(TABLE), territory="shared").territories == ()


@pytest.mark.parametrize("margin", [0.0, 1.0, 2.5])
def test_supports_stay_in_the_columns_of_the_shadow_and_its_margin(margin):
    plan = layout(placed(TABLE), territory_margin_mm=margin, **OWN)
    assert plan.connected.all()
    low, high = 20 - int(margin), 40 + int(margin)
    assert all(low <= y < high and low <= x < high for y, x in columns_in_use(plan))


def test_no_voxel_in_the_box_of_another_part_is_open_when_boxes_are_apart():
    post = box((4, 4, 20), (41, 28, 0))
    parts = placed(TABLE, post)
    rules = PlanningRules(pitch_mm=1.0, territory_margin_mm=5.0, **OWN)
    plan = layout(parts, territory_margin_mm=5.0, **OWN)
    laid = make_grid(parts, plan.overhangs, SPACE, rules)
    table, _ = find_territories(parts, laid, rules)
    x0, y0, _ = np.round(laid.grid.origin).astype(int)
    inside = np.array([(k, y - y0, x - x0) for k in range(8) for y in range(28, 32) for x in range(41, 45)])
    beside = np.array([(9, 28 - y0, 40 - x0)])
    assert not table.allows(inside).any()
    assert table.allows(beside).all()


def test_supports_keep_out_of_the_shadow_of_another_part_but_may_use_their_own():
    """Two hooks in one another: each is in the box of the other, and their shadows overlap in part."""
    low = box((30, 10, 4), (10, 20, 0))
    high = box((10, 20, 4), (20, 10, 20)) + box((4, 4, 24), (23, 12, 0))
    plan = layout(placed(high, low), territory_margin_mm=2.0, **OWN)
    assert plan.connected.any()
    for y, x in columns_in_use(plan):
        assert not (10 <= x < 40 and 20 <= y < 30) or 20 <= x < 30


def test_a_part_above_another_gets_no_supports_through_the_box_of_that_part():
    below = box((20, 20, 3), (20, 20, 0)) - box((6, 6, 5), (27, 27, -1))
    plan = layout(placed(box((16, 16, 3), (22, 22, 12)), below), territory_margin_mm=1.0, **OWN)
    inner = plan.red.part == 0
    assert not plan.connected[inner].any()
    assert set(np.array(plan.reasons)[inner & (plan.red.square[:, 0] > 0)]) == {TERRITORY}


def test_red_squares_whose_only_path_leaves_the_territory_are_listed_with_that_reason():
    """The ceiling of a room that is open at one side can only be reached from outside through that side."""
    room = box((12, 12, 14), (20, 20, 0)) - box((10, 12, 4), (21, 19, 6))
    shared, own = (layout(placed(room), territory=each) for each in ("shared", "own"))
    ceiling = own.red.square[:, 0] == 10
    assert shared.connected[ceiling & (own.red.square[:, 1] == own.red.square[ceiling, 1].min())].all()
    assert set(np.array(own.reasons)[ceiling]) <= {TERRITORY, ENCLOSED}
    lost = np.array([reason == TERRITORY for reason in own.reasons])
    assert (lost == (shared.connected & ~own.connected)).all()
    assert lost.any()


@pytest.mark.parametrize("share", ["avoid", "allow"])
def test_both_ways_of_sharing_respect_territories(share):
    parts = placed(ROOF, box((8, 8, 3), (34, 22, 6)))
    plan = layout(parts, share_between_parts=share, territory_margin_mm=1.0, **OWN)
    assert plan.connected.all()
    assert all(19 <= x < 33 for _, x in columns_in_use(plan, 0))
    assert all(33 <= x < 43 for _, x in columns_in_use(plan, 1))
    assert plan.shared == ()


def test_columns_on_parts_stay_in_the_territory():
    shelf = box((12, 12, 2), (20, 20, 0)) + box((12, 2, 20), (20, 30, 0)) + box((12, 12, 2), (20, 20, 18))
    plan = layout(placed(shelf), grounding="anywhere", territory_margin_mm=1.0, **OWN)
    assert len(plan.feet) > 0
    assert plan.connected.all()


def test_a_surface_without_a_shadow_has_the_columns_of_its_red_squares():
    """A vertical wall without thickness, whose lower edge is above the plate."""
    mesh = Mesh(
        [(10.5, 20.5, 6), (20.5, 20.5, 6), (20.5, 20.5, 12), (10.5, 20.5, 12)], [(0, 1, 2), (0, 2, 3)]
    )
    part = Part("wall", mesh, 0.0, is_solid=False)
    plan = layout([PlacedPart("wall", part, np.eye(4))], **OWN)
    assert plan.connected.any()
    assert {y for y, _ in columns_in_use(plan)} == {20}


def test_red_squares_too_far_from_the_edge_of_what_is_below_them_are_listed():
    """A slab 16 mm above a block on the plate: supports may drift a third of that height to get beside the block."""
    block, slab = box((30, 20, 4), (10, 10, 0)), box((30, 20, 2), (10, 10, 20))
    parts = placed(block + slab + box((2, 20, 22), (38, 10, 0)))
    plan = layout(parts, territory_margin_mm=20.0, **OWN)
    free = layout(parts, territory_margin_mm=20.0, territory="own")
    assert free.connected.all()
    assert set(plan.reasons) == {"", TERRITORY}
    y, x = plan.red.square[:, 1:].T + np.round(plan.grid.origin[1::-1]).astype(int)[:, None]
    assert (plan.connected == ((y < 15) | (y >= 25) | (x < 15))).all()
