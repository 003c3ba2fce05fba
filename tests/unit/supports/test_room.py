"""The room that supports need beside a part, on parts where it is known by hand."""

import pytest
from tests.shared.layouts import box, layout, placed

from amprep.overhangs.of_part import overhangs_of
from amprep.supports.plan import PlanningRules
from amprep.supports.room import needed_margin

RULES = PlanningRules(territory="own", territory_margin_mm=1.0, drift_ratio=1 / 3, drift_mm=15.0)
TABLE = box((20, 20, 3), (20, 20, 10)) + box((6, 6, 10), (27, 27, 0))
BLOCK_BELOW = box((20, 20, 4), (20, 20, 0)) + box((20, 20, 2), (20, 20, 30)) + box((20, 2, 32), (20, 38, 0))
"""Half of the slab at the top can only be supported from beside the block on the plate, 8.3 mm away at most."""


def margin_of(solid, rules=RULES):
    (part,) = placed(solid)
    return needed_margin(part, overhangs_of(part, rules), rules)


def test_a_part_whose_supports_stand_below_it_needs_no_more_room():
    assert margin_of(TABLE) == 1.0
    assert margin_of(box((5, 5, 5), (10, 10, 0))) == 1.0


def test_a_part_whose_supports_stand_beside_it_needs_room_and_gets_its_supports_with_it():
    needed = margin_of(BLOCK_BELOW)
    assert 1.0 < needed <= 4.0

    def lost(margin):
        plan = layout(
            placed(BLOCK_BELOW),
            territory="own",
            territory_margin_mm=margin,
            drift_ratio=1 / 3,
            drift_mm=15.0,
            pitch_mm=1.9,
        )
        return int((~plan.connected).sum())

    assert lost(needed) < lost(1.0)
    assert lost(needed) <= lost(15.0) + 4  # of another grid


def test_no_room_helps_where_supports_may_not_drift():
    assert (
        margin_of(BLOCK_BELOW, PlanningRules(territory="own", territory_margin_mm=1.0, drift_mm=0.5)) == 1.0
    )


def test_large_parts_get_a_coarse_grid():
    assert margin_of(BLOCK_BELOW.scale((20, 20, 20)).translate((-300, -300, 0))) >= 1.0


@pytest.mark.parametrize("own", [15.0, 30.0])
def test_a_margin_that_is_as_large_as_the_drift_is_kept(own):
    assert (
        margin_of(BLOCK_BELOW, PlanningRules(territory="own", territory_margin_mm=own, drift_mm=15.0)) == own
    )
