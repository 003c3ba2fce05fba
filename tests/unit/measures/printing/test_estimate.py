"""Mass, use of the plate and hours of builds are those of solids whose figures are known by hand."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.builds import box_mesh
from tests.shared.solids import mesh_of

from amprep.measures.printing.estimate import PrintingRates, estimate_printing, plate_use
from amprep.measures.removability import RemovalRules, measure_removal
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart, SupportBody

RATES = PrintingRates(layer_mm=0.05, recoating_s=9.0, scan_mm2_s=40.0)


def placed(mesh, *place, degrees=0.0, label="part"):
    turn = np.radians(degrees)
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    matrix[:3, 3] = place
    return PlacedPart(label, Part(label, mesh, mesh.signed_volume), matrix)


def build_of(*parts, supports=(), shape="box"):
    size = np.array([100.0, 100.0, 50.0])
    return Build(BuildSettings("none", BuildVolume(size, shape)), parts, tuple(supports))


CUBE = box_mesh((0, 0, 0), (10, 10, 10))


def estimate(build, densities, rates=RATES):
    known = tuple(densities)
    return estimate_printing(build, known, measure_removal(build, RemovalRules(0.05, known)), rates)


def test_two_cubes_and_a_support_have_the_mass_and_hours_of_their_volume():
    support = SupportBody("support", box_mesh((0, 0, 0), (10, 10, 3)), (0,))
    build = build_of(placed(CUBE, 0, 0, 3), placed(CUBE, 20, 0, 3), supports=[support])
    found = estimate(build, [8.0, 2.0])
    assert (found.parts_g, found.supports_g) == (pytest.approx(10.0), pytest.approx(2.4))
    assert found.mass_g == pytest.approx(12.4)
    assert found.layers == 260, "13 mm in layers of 0.05 mm"
    assert found.recoating_h == pytest.approx(260 * 9 / 3600)
    assert found.scanning_h == pytest.approx(2300 / 0.05 / 40 / 3600)
    assert found.hours == pytest.approx(found.recoating_h + found.scanning_h)
    assert found.density == pytest.approx(2000 / (100 * 100 * 13))


def test_an_unknown_density_leaves_the_mass_unknown():
    support = SupportBody("support", box_mesh((0, 0, 0), (10, 10, 3)), (0,))
    build = build_of(placed(CUBE, 0, 0, 3), placed(CUBE, 20, 0, 3), supports=[support])
    found = estimate(build, [8.0, None])
    assert (found.parts_g, found.mass_g) == (None, None)
    assert found.supports_g == pytest.approx(2.4)
    assert estimate(build, [None, 2.0]).supports_g is None
    assert estimate(build_of(placed(CUBE, 0, 0, 0)), [2.0]).mass_g == pytest.approx(2.0), "without supports"


@pytest.mark.parametrize(("shape", "plate"), [("box", 1e4), ("cylinder", np.pi * 2500)])
def test_shadows_above_each_other_cover_the_plate_once_and_holes_are_free(shape, plate):
    ring = mesh_of(Manifold.cube([30, 30, 4]) - Manifold.cube([10, 10, 9]).translate([10, 10, -1]))
    parts = [placed(ring, 40, 40, 0), placed(ring, 40, 40, 10), placed(CUBE, 65, 40, 20)]
    build = build_of(*parts, shape=shape)
    assert plate_use(build) == pytest.approx((800 + 50) / plate)


def test_the_plate_use_of_turned_parts_is_what_samples_of_the_plate_say():
    parts = [placed(CUBE, 20 * i, 30, 0, degrees=17 * i) for i in range(1, 5)]
    build = build_of(*parts, placed(CUBE, 25, 33, 15, degrees=45))
    rng = np.random.default_rng(1)
    points = rng.uniform(0, 100, (40_000, 2))
    inside = np.zeros(len(points), bool)
    for each in build.parts:
        own = (points - each.matrix[:2, 3]) @ each.matrix[:2, :2]
        inside |= ((own >= 0) & (own <= 10)).all(axis=1)
    assert plate_use(build) == pytest.approx(inside.mean(), abs=0.004)


def test_an_empty_build_takes_nothing():
    found = estimate(build_of(), [])
    assert (found.mass_g, found.layers, found.hours, found.plate_use, found.density) == (0, 0, 0, 0, 0)


def test_cost_is_that_of_hours_and_powder_and_parts_share_it_by_volume():
    support = SupportBody("support", box_mesh((0, 0, 0), (10, 10, 3)), (0,))
    shared = SupportBody("shared", box_mesh((0, 0, 0), (10, 10, 2)), (0, 1))
    build = build_of(placed(CUBE, 0, 0, 3), placed(CUBE, 20, 0, 3), supports=[support, shared])
    rates = replace(RATES, heating_h=2.0, cooling_h=3.0, hour_price=50.0, powder_price_kg=80.0)
    found = estimate(build, [8.0, 8.0], rates)
    assert found.shares == pytest.approx((1400 / 2500, 1100 / 2500))
    assert found.hours == pytest.approx(5.0 + found.recoating_h + found.scanning_h)
    assert found.cost == pytest.approx(found.hours * 50.0 + 0.020 * 80.0)
    assert estimate(build, [8.0, None], rates).cost is None, "the mass is unknown"
    assert estimate(build, [8.0, 8.0], replace(rates, hour_price=None)).cost is None
    assert estimate(build_of(), [], rates).cost == 0.0
