"""Packers of true shapes claim that a part is too large, or a job infeasible, only where it is proved."""

from typing import Any

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import (
    BuildVolume,
    Item,
    Orientations,
    PackingProblem,
    Stop,
    silent,
)
from amprep.plugins.packers.auto import pack_auto
from amprep.plugins.packers.params import AutoParams, PlatesParams, SeparationParams
from amprep.plugins.packers.plates import pack_plates
from amprep.plugins.packers.separation import pack_separation

PACKERS: dict[str, tuple[Any, Any, tuple[bool, ...]]] = {
    "auto": (pack_auto, AutoParams(work=1.0, proof=1.0, separation=1.0, plates=1.0), (True, False)),
    "separation": (pack_separation, SeparationParams(work=1.0), (True,)),
    "plates": (pack_plates, PlatesParams(work=1.0, failures=1), (False,)),
}
CASES = [(name, stacking) for name, (_, _, kept) in PACKERS.items() for stacking in kept]
EACH = pytest.mark.parametrize(("name", "stacking"), CASES)

TILT = np.array([[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]])


def pack(name, volumes, size, stacking, objective="builds", allowed=None, stop=None, zones=(), **rules):
    corners = np.array(zones, float).reshape(-1, 6)
    space = BuildVolume(np.array(size, float), "box", corners[:, :3], corners[:, 3:])
    items = tuple(
        Item(k, 0, volume, 2.0, allowed or Orientations(), exact=True) for k, volume in enumerate(volumes)
    )
    problem = PackingProblem(items, space, objective, stacking=stacking, **rules)
    run, params, _ = PACKERS[name]
    rng = np.random.default_rng(1)
    packing = run(problem, params=params, rng=rng, stop=stop or Stop(), progress=silent)
    assert check_packing(problem, packing) == []
    return packing


@EACH
@pytest.mark.parametrize("objective", ["builds", "fill", "height"])
def test_a_part_that_fits_beside_a_zone_is_not_called_too_large(name, stacking, objective):
    prism = volume_of_solid(Manifold.extrude(CrossSection([[(0, 0), (30, 0), (0, 30)]]), 30.0))
    packing = pack(name, [prism], (30, 30, 30), stacking, objective, zones=[(20, 20, 0, 40, 40, 40)])
    assert packing.status != "infeasible"
    assert all(each.reason == "no room left" for each in packing.unplaced)
    if objective == "fill":
        assert packing.bound == pytest.approx(2.0)
        assert packing.status == ("feasible" if packing.unplaced else "optimal")


@EACH
def test_a_part_longer_than_the_build_is_too_large_and_the_job_infeasible(name, stacking):
    packing = pack(name, [volume_of_solid(Manifold.cube([31.0, 2.0, 2.0]))], (30, 30, 30), stacking)
    assert [each.reason for each in packing.unplaced] == ["too large"]
    assert packing.status == "infeasible"


@EACH
def test_the_bound_on_the_height_is_that_of_the_part_and_not_of_pieces_around_it(name, stacking):
    ball = volume_of_solid(Manifold.sphere(15.0, 96))
    rotation = TILT @ np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    packing = pack(name, [ball], (60, 60, 60), stacking, "height", Orientations(matrices=rotation[None]))
    assert packing.bound == pytest.approx(np.ptp(ball.mesh.vertices @ rotation[2]))


@EACH
@pytest.mark.parametrize("seconds", [0.0, None])
def test_tilted_parts_stand_on_the_plate_even_after_a_stop(name, stacking, seconds):
    rod = volume_of_solid(Manifold.hull_points([[0, 0, 0], [40, 0, 0], [0, 8, 3], [5, 2, 9], [20, 9, 4]]))
    packing = pack(
        name,
        [rod, rod],
        (60, 60, 60),
        stacking,
        allowed=Orientations(matrices=TILT[None]),
        stop=Stop.after(seconds),
        lift=3.0,
    )
    assert not packing.unplaced


@EACH
def test_all_of_the_value_is_proved_to_be_the_greatest(name, stacking):
    packing = pack(
        name, [volume_of_solid(Manifold.cube([4.0, 2.0, 2.0]))] * 3, (30, 30, 30), stacking, "fill"
    )
    assert packing.status == "optimal"


def test_separation_packs_boxes_where_its_work_ends_before_every_part_is_placed(monkeypatch):
    monkeypatch.setitem(PACKERS, "separation", (pack_separation, SeparationParams(work=0.0), (True,)))
    parts = [volume_of_solid(Manifold.cube([9.0, 9.0, 9.0]))] * 8
    for objective in ("builds", "height", "fill"):
        assert not pack("separation", parts, (20, 20, 20), True, objective).unplaced
