"""Regions are supported in passes by the first rule that fits; bodies of passes never overlap, whatever their cells."""

import itertools
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.optional import present
from tests.shared.solids import mesh_of

import amprep
from amprep.geometry.meshes.manifold import as_manifold
from amprep.host import Host
from amprep.model import Part
from amprep.model.supports import CONNECTOR_BLOCKED, ENCLOSED, EXCEPTED, TERRITORY
from amprep.pipeline.passes import PlannedPass, plan_in_order
from amprep.threemf import read_build

CELLS = sorted(Host.load(plugins_enabled=False).offers("cell"))
THESIS = {
    "supports.rules": "thesis",
    "supports.territory": "shared",
    "supports.drift_mm": 0.0,
    "supports.contact_spacing_mm": 0.0,
    "supports.pitch_mm": 2.0,
    "printer": "EOS M290",
}


def tree():
    """A post with a slab on it and an arm that leads out of it at half height, 40 mm from the corner of the plate."""
    post, slab = Manifold.cube([6, 20, 20]), Manifold.cube([30, 20, 3]).translate([-12, 0, 17])
    arm = Manifold.cube([14, 6, 3]).translate([-14, 7, 8])
    solid = (post + slab + arm).translate([40, 40, 0])
    return Part("tree", mesh_of(solid), solid.volume())


SLAB, ARM = {"area": [100]}, {"area": [1, 100]}


def supported(*rules, part=None, **settings):
    loaded = amprep.load(part or tree(), settings={**THESIS, "rule": list(rules), **settings})
    return amprep.emit_cells(amprep.plan_supports(loaded))


def common(build):
    """The greatest volume that two bodies have in common."""
    solids = [as_manifold(*each.mesh.arrays) for each in build.supports if not each.surface]
    return max([(a ^ b).volume() for a, b in itertools.combinations(solids, 2)], default=0.0)


def violations(found, folder):
    return amprep.verify(amprep.write(found, folder / "tree.3mf")).violations


def test_without_rules_and_with_a_rule_that_changes_nothing_there_is_one_pass():
    plain, same = supported(), supported({**SLAB, "pitch_mm": 2.0}, {"height": [900], "cell": "prism"})
    assert [len(each.layouts) for each in (plain, same)] == [1, 1]
    for one, other in zip(plain.build.supports, same.build.supports, strict=True):
        np.testing.assert_array_equal(one.mesh.vertices, other.mesh.vertices)


def test_the_first_rule_that_fits_takes_a_region():
    planned = amprep.plan_supports(
        amprep.load(
            tree(),
            settings={
                **THESIS,
                "rule": [
                    {**ARM, "cell": "prism"},
                    {"kind": "face", "cell": "strut"},
                    {**ARM, "support": False},
                ],
            },
        )
    )
    areas = [region.measure for region in present(planned.taken).overhangs[0].overhangs.regions]
    assert present(planned.taken).rules[0].tolist() == [1 if area < 100 else 2 for area in areas]
    assert [each.rules for each in planned.passes] == [(0,), (1,), (2,)]
    assert [len(layout.red.square) > 0 for layout in planned.layouts] == [False, True, True]


@pytest.mark.parametrize("cell", CELLS)
def test_bodies_of_passes_do_not_overlap_and_keep_all_promises_with_every_cell(cell, tmp_path):
    rule = {**ARM, "cell": cell, "pitch_mm": 1.3, "connector": "teeth"}
    found = supported(rule, **{"cells.base": "flange", "target": "generic"})
    assert len({body.name for body in found.build.supports}) >= 2
    assert common(found.build) < 1e-4
    assert [each for each in found.build.unsupported if not each.minor] == []
    assert violations(found, tmp_path) == ()


@given(first=st.floats(0.8, 2.2), second=st.floats(0.8, 2.2), connector=st.sampled_from(["teeth", "point"]))
@examples(3)
def test_bodies_of_passes_do_not_overlap_at_any_pitch(first, second, connector):
    rule = {**SLAB, "pitch_mm": second, "connector": connector, "cell": "prism"}
    found = supported(rule, **{"supports.pitch_mm": first, "cells.strategy": "prism"})
    assert len(found.build.supports) == 2
    assert common(found.build) < 1e-4
    assert [each for each in found.build.unsupported if not each.minor] == []


def test_each_body_is_recorded_and_judged_with_the_reach_and_the_sizes_of_its_pass(tmp_path):
    rule = {**ARM, "pitch_mm": 1.0, "connector": "teeth", "tooth_width_mm": 0.5}
    found = supported(rule, **{"cells.strategy": "prism"})
    file = amprep.write(found, tmp_path / "tree.3mf")
    slab, arm = read_build(file).supports
    settings = read_build(file).settings
    assert [settings.reach_of(each) for each in (slab, arm)] == [3.0, 1.5]
    assert [settings.sizes_of(each).square_mm for each in (slab, arm)] == [2.0, 1.0]
    assert [settings.sizes_of(each).tip_width_mm for each in (slab, arm)] == [0.0, 0.5]
    solid = as_manifold(*found.build.supports[1].mesh.arrays)
    low = found.build.supports[1].mesh.bounds[0]
    shorter = solid - Manifold.cube([2.2, 50, 50]).translate([low[0] - 0.1, low[1] - 1, -1])
    cut = replace(found.build.supports[1], mesh=mesh_of(shorter))
    for reach, promises in ((1.5, ["coverage"]), (3.0, [])):
        bodies = (found.build.supports[0], replace(cut, reach=reach))
        changed = replace(found, build=replace(found.build, supports=bodies))
        assert [each.promise for each in violations(changed, tmp_path)] == promises


def test_an_excepted_region_is_listed_with_its_rule_and_is_no_fault(tmp_path):
    found = supported({**ARM, "support": False})
    (listed,) = found.build.unsupported
    assert (listed.reason, listed.minor, listed.is_small) == (EXCEPTED, True, False)
    assert listed.measure == pytest.approx(14.0 * 6.0, rel=0.1), "the arm from the post to its end"
    assert (listed.points[:, 2] == 8.0).all()
    assert violations(found, tmp_path) == ()


def test_verify_finds_an_excepted_region_that_is_not_listed(tmp_path):
    found = supported({**ARM, "support": False})
    silent = replace(found, build=replace(found.build, unsupported=()))
    assert [each.promise for each in violations(silent, tmp_path)] == ["coverage"]


def test_an_overhang_smaller_than_the_gap_is_listed_and_no_support_is_made():
    solid = (Manifold.cube([10, 10, 10]) + Manifold.cube([12, 12, 2]).translate([-1, -1, 0.5])).translate(
        [40, 40, 0]
    )
    lip = Part("lip", mesh_of(solid), solid.volume())
    settings = {"printer": "EOS M290", "supports.gap_mm": 2.0}
    found = amprep.emit_cells(amprep.plan_supports(amprep.load(lip, settings=settings)))
    assert found.build.supports == ()
    assert {each.reason for each in found.build.unsupported} == {CONNECTOR_BLOCKED}


def test_rules_that_take_no_region_of_any_build_are_noted(tmp_path):
    from amprep.stl import write_stl

    write_stl(tree().mesh, tmp_path / "tree.stl")
    rules = [{"height": [900], "cell": "prism"}, {**ARM, "support": False}, {**ARM, "cell": "prism"}]
    notes = [
        amprep.support(
            tmp_path / "tree.stl", output=tmp_path, settings={**THESIS, "rule": given}, dry_run=True
        ).notes
        for given in (rules, rules[1:2])
    ]
    assert [[each for each in found if "[[rule]]" in each] for found in notes] == [
        ["no overhang meets the conditions of [[rule]] 1, 3, or earlier entries take them"],
        [],
    ]


def test_the_report_adds_the_figures_of_all_passes(tmp_path):
    from amprep.stl import write_stl

    write_stl(tree().mesh, tmp_path / "tree.stl")
    rules = [{**ARM, "pitch_mm": 1.0}, {**SLAB, "cell": "prism"}]
    record = amprep.support(
        tmp_path / "tree.stl", output=tmp_path, settings={**THESIS, "rule": rules}, dry_run=True
    )
    (build,) = record.builds
    assert record.faults == 0
    assert build.demand_squares == sum(each.demand_squares for each in build.overhangs)
    assert [each.connected_squares == each.demand_squares > 0 for each in build.overhangs] == [True] * 3
    excepted = amprep.support(
        tmp_path / "tree.stl",
        output=tmp_path,
        settings={**THESIS, "rule": [{**ARM, "support": False}]},
        dry_run=True,
    )
    assert excepted.faults == 0
    states = [each.supported for each in excepted.builds[0].overhangs if each.reasons == (EXCEPTED,)]
    assert states in (["not"], ["partly"]), "its rim may be on a support of the slab"


def planner(lost_after, calls):
    """Passes of four red squares; `lost_after` gives the squares and the reason that pass a loses after pass b."""

    def plan(number, earlier):
        calls.append((number, tuple(each.rules[0] for each in earlier)))
        reasons = [""] * 4
        for each in earlier:
            lost, reason = lost_after.get((number, each.rules[0]), (0, ""))
            reasons[:lost] = [reason] * lost
        if number == 0:
            reasons[3] = ENCLOSED  # in a closed room, whatever the order
        connected = np.array([reason == "" for reason in reasons])
        layout: Any = SimpleNamespace(reasons=tuple(reasons), connected=connected)
        return PlannedPass((number,), 1.0, layout)

    return plan


def lost(planned):
    return [int((~each.layout.connected).sum()) for each in planned]


@pytest.mark.parametrize(
    ("lost_after", "expected"),
    [
        ({}, [1, 0, 0]),
        ({(2, 0): (3, ENCLOSED)}, [1, 0, 0]),
        ({(2, 0): (3, ENCLOSED), (0, 2): (1, ENCLOSED)}, [2, 0, 0]),
        ({(2, 0): (3, ENCLOSED), (1, 2): (3, ENCLOSED)}, [1, 0, 3]),
        ({(1, 0): (2, ENCLOSED), (2, 0): (2, ENCLOSED)}, [1, 0, 2]),
        ({(2, 0): (3, TERRITORY)}, [1, 0, 3]),
    ],
)
def test_the_order_connects_as_many_as_one_pass_moved_to_the_front_can(lost_after, expected):
    planned = plan_in_order(3, planner(lost_after, []))
    assert [each.rules for each in planned] == [(0,), (1,), (2,)]
    assert lost(planned) == expected


def test_passes_that_do_not_enclose_each_other_are_planned_once():
    calls: list[tuple[int, tuple[int, ...]]] = []
    plan_in_order(3, planner({}, calls))
    assert calls == [(0, ()), (1, (0,)), (2, (0, 1))]
