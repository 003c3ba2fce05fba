"""Boxes that a pass had no time for are put into rows: a late answer is a whole one."""

from typing import Any

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.auto import pack_auto
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import AutoParams, ExtremePointsParams, TabuParams
from amprep.plugins.packers.tabu import pack_tabu

pytestmark = pytest.mark.compiled

PACKERS: dict[str, Any] = {
    "extreme-points": (pack_extreme_points, ExtremePointsParams()),
    "auto": (pack_auto, AutoParams()),
    "tabu": (pack_tabu, TabuParams()),
}
TURNS = Orientations("list", axis_rotations())


def small_boxes(count, **rules):
    sizes = np.random.default_rng(count).uniform(1.0, 10.0, (count, 3))
    items = tuple(
        Item(
            i,
            0,
            Boxes(np.zeros((1, 3)), size[None]),
            float(size.prod()),
            TURNS if i % 3 == 0 else Orientations(),
        )
        for i, size in enumerate(sizes)
    )
    return PackingProblem(items, BuildVolume(np.array([60.0, 50.0, 40.0])), **rules)


def pack_without_time(packer, task):
    stop = Stop()
    stop.cancelled.set()
    run, params = PACKERS[packer]
    packing = run(task, params=params, rng=np.random.default_rng(0), stop=stop, progress=silent)
    assert check_packing(task, packing) == []
    return packing


@pytest.mark.parametrize(
    ("packer", "count", "rules"),
    [
        ("extreme-points", 800, {}),
        ("extreme-points", 800, {"clearance": 0.5}),
        ("auto", 800, {"stacking": False}),
        ("tabu", 200, {"clearance": 0.5}),
    ],
    ids=str,
)
def test_a_packer_without_any_time_places_everything(packer, count, rules):
    packing = pack_without_time(packer, small_boxes(count, **rules))
    assert packing.unplaced == ()
    assert len(packing.builds) <= 2 * packing.bound + 1


def test_what_stands_stays_where_it_is():
    task = small_boxes(800, fixed=(Placement(5, np.eye(3), np.array([20.0, 20.0, 0.0])),))
    packing = pack_without_time("extreme-points", task)
    assert packing.unplaced == ()
    assert packing.builds[0][0].item == 5
