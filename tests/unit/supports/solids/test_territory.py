"""Finished supports are clipped to the territories of their parts, where their cells may stick out."""

import numpy as np
import pytest
from tests.shared.layouts import box, layout, placed

from amprep.cells.instances import classify
from amprep.host import Host
from amprep.model import Stop, silent
from amprep.model.contacts import BaseRules
from amprep.supports.solids.bases import make_bases
from amprep.supports.solids.request import make_request
from amprep.supports.solids.territory import clip_to_territory, territory_section

OWN = {"territory": "own", "drift_ratio": 1 / 3, "drift_mm": 15.0}
TABLE = box((20, 20, 3), (20, 20, 10)) + box((6, 6, 10), (27, 27, 0))
HOST = Host.load(plugins_enabled=False)


def instances_of(plan, size=1.0):
    """The prisms of a plan, whose templates are `size` times as wide as the unit cube."""
    listed = HOST.choose("cell", "prism")
    request = make_request(plan, (), overlap=0.1, allow_surface=False, extend=False)
    cells = HOST.call(listed, request, params=HOST.params(listed, {}), stop=Stop(), progress=silent)
    found = classify(request, cells)
    return found._replace(templates=tuple((points * size, corners) for points, corners in found.templates))


def clipped(solid, plan, **cells):
    return clip_to_territory(plan, 0, solid, instances_of(plan, **cells))


WHOLE = layout(placed(TABLE), territory_margin_mm=2.0, **OWN)
PARTIAL = layout(placed(TABLE.translate((0.5, 0, 0))), territory_margin_mm=0.0, **OWN)


def test_solids_in_whole_columns_stay_as_they_are():
    solid = box((2, 2, 8), (20, 20, 0))
    assert clipped(solid, WHOLE) is solid


@pytest.mark.parametrize(("plan", "size", "low"), [(WHOLE, 1.1, 18.0), (PARTIAL, 1.0, 20.5)])
def test_what_sticks_out_is_cut_off_by_the_shadow_with_its_margin(plan, size, low):
    found = clipped(box((8, 4, 8), (16, 25, 0)), plan, size=size)
    assert found.bounding_box()[0] == pytest.approx(low, abs=1e-6)
    assert found.volume() == pytest.approx((24 - low) * 4 * 8, rel=1e-6)


def test_supports_of_shared_space_are_not_clipped():
    solid = box((4, 4, 8), (16, 25, 0))
    plan = layout(placed(TABLE))
    assert clipped(solid, plan) is solid
    assert territory_section(plan, 0) is None


def test_boxes_of_parts_below_are_cut_out():
    parts = placed(box((20, 20, 3), (20, 20, 12)), box((8, 8, 2), (21, 21, 0)))
    plan = layout(parts, territory_margin_mm=1.0, **OWN)
    found = clipped(box((10, 10, 4), (20, 20, 0)), plan)
    assert found.volume() == pytest.approx(400 - 8 * 8 * 2)


def test_bases_stay_in_the_territory():
    foot = box((1, 1, 8), (38.5, 38.5, 0))
    (base,) = make_bases(
        [foot],
        placed(TABLE),
        BaseRules(base="raft", raft_margin_mm=5.0),
        None,
        0.0,
        regions=[territory_section(WHOLE, 0)],
    )
    assert base is not None
    assert np.array(base.bounding_box())[3:5] == pytest.approx([42, 42], abs=1e-5)
