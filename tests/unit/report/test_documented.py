"""Every key of the JSON reports is described in docs/report.md."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from amprep.checks.violation import Violation
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.geometry.powder.pockets import Pocket
from amprep.infill.fill_region import FilledPart
from amprep.measures.legs import BodyLegs, MeasuredLeg
from amprep.measures.removability import Removal
from amprep.model import Part
from amprep.report import infill, json_report
from amprep.report.infill import FilledPartRecord, InfillRecord
from amprep.report.record import (
    BuildRecord,
    OverhangRecord,
    RunRecord,
    StageTime,
    UnconnectedSquare,
    UnplacedRecord,
)
from amprep.testing.problems import box_mesh

PAGE = (Path(__file__).parents[3] / "docs" / "report.md").read_text(encoding="utf-8")
POCKET = Pocket(2.0, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), True)
BROKEN = Violation("clearance", "bar", "expected 0.5 mm, found 0.2 mm")
FILLED = FilledPartRecord(
    Part("wheel", box_mesh([0, 0, 0], [10, 5, 2]), 100.0),
    regions=("web",),
    filled=FilledPart(
        mesh=box_mesh([0, 0, 0], [10, 3, 2]),
        cells=box_mesh([0, 0, 0], [10, 1, 1]),
        region=box_mesh([0, 0, 0], [5, 5, 2]),
        count=8,
        cells_mm3=10.0,
        dropped_components=2,
        dropped_volume_mm3=0.5,
        genus=1,
    ),
    density_g_cm3=None,
    pockets=(POCKET,),
    pockets_before_mm3=0.5,
    violations=(BROKEN,),
)
INFILL = InfillRecord(
    "job", "1.0", "bcc", 4.0, 4.0, 0.2, (FILLED,), ("axle",), ("job.lattice.3mf",), (StageTime("read", 1.0),)
)


def keys(value):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield key
            if key != "settings":
                yield from keys(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys(inner)


def described(section):
    """Keys in code spans, without brackets and the keys that contain them."""
    return {span.removesuffix("[]").split(".")[-1] for span in re.findall(r"`([\w.\[\]]+)`", section)}


LEG = MeasuredLeg(12.0, 24.0, 2.0, (1.0, 1.0, 12.0))


@pytest.fixture
def run(make_build) -> RunRecord:
    """Return a run that has every kind of entry."""
    build = make_build()
    at = (0.0, 0.0, 1.0)
    entry = BuildRecord(
        build,
        unconnected=(UnconnectedSquare("bar", "overhang 1 of bar", "enclosed", (4, 2, 1), at),),
        verification=(BROKEN,),
        overhangs=(
            OverhangRecord(
                "overhang 1 of bar",
                "bar",
                OverhangRegion("ledge", 12.5, np.zeros(3), 6.0, 1.0),
                at,
                "ledge 6.0 mm over 1.0",
                "must fix",
                "partly",
                ("enclosed",),
            ),
        ),
        legs=tuple(BodyLegs(1, LEG, (LEG,)) for _ in build.supports),
        removal=tuple(Removal(1.0, 2.0, 3.0, 4, (POCKET,), 0.1) for _ in build.supports),
    )
    return RunRecord(
        "job",
        "1.0",
        1,
        "MK4",
        "generic",
        (entry,),
        (UnplacedRecord("crane", 1, "too large"),),
        (StageTime("read", 1.0),),
    )


def test_every_key_of_the_run_report_is_described(run):
    section = PAGE.split("## `NAME.lattice.report.json`")[0]
    assert set(keys(json_report.to_json(run))) - described(section) == set()


def test_every_key_of_the_lattice_report_is_described():
    assert set(keys(infill.to_json(INFILL))) - described(PAGE) == set()


def test_keys_use_the_words_of_the_glossary_only(run):
    found = {*keys(json_report.to_json(run)), *keys(infill.to_json(INFILL))}
    assert not found & {"red", "green", "held", "pieces", "islands", "shared", "untouched"}


def test_powder_that_cannot_leave_dropped_components_and_broken_promises_are_warnings():
    powder, dropped, broken = infill.warnings_of(INFILL)
    assert powder.startswith(
        "wheel: 1.5 mm3 of powder in 1 pocket cannot leave, 3.8% of the powder between the cells"
    )
    assert "more open cell" not in powder, "3.8 % is little"
    assert dropped == ("wheel: dropped 2 disconnected components of cells (0.5 mm3) that nothing holds")
    assert broken == "wheel: clearance: expected 0.5 mm, found 0.2 mm"
    much = replace(INFILL, parts=(replace(FILLED, pockets=(POCKET._replace(volume=20.0),)),))
    assert "more open cell" in next(infill.warnings_of(much))


def test_powder_that_was_trapped_before_is_no_warning():
    filled = replace(FILLED.filled, dropped_components=0)
    before = replace(FILLED, filled=filled, pockets_before_mm3=2.0, violations=())
    assert list(infill.warnings_of(replace(INFILL, parts=(before,)))) == []
