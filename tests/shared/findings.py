"""Regions of overhangs with known verdicts, and runs that consist of them."""

from collections.abc import Sequence

import numpy as np

from amprep.geometry.overhangs.regions import Kind, OverhangRegion
from amprep.model import Build, BuildSettings, BuildVolume
from amprep.report.record import BuildRecord, OverhangRecord, RunRecord
from amprep.report.triage.classes import Triage


def overhang(
    name: str,
    triage: Triage = "supported",
    *,
    kind: Kind = "ledge",
    part: str = "bar",
    size: float = 0.0,
    limit: float = 0.0,
    measure: float = 1.0,
    position: tuple[float, float, float] = (10.0, 20.0, 30.0),
) -> OverhangRecord:
    """Return a region of a class, with a verdict that names its kind and its name."""
    carried = triage in ("self-supporting", "worth a check")
    region = OverhangRegion(
        kind, measure, np.array(position), size, limit, is_self_supporting=carried, lowest_mm=position[2]
    )
    return OverhangRecord(name, part, region, position, f"verdict on {kind} {name}", triage, "fully")


def run_of(overhangs: Sequence[OverhangRecord], builds: int = 1) -> RunRecord:
    """Return a run of builds without parts that have these regions."""
    settings = [BuildSettings(f"job.build-{k + 1}", BuildVolume((100, 100, 100))) for k in range(builds)]
    entries = tuple(BuildRecord(Build(each, ()), overhangs=tuple(overhangs)) for each in settings)
    return RunRecord("job", "1.0", 0, "MK4", "generic", entries)


def run_of_overhangs(triages: Sequence[Triage], builds: int = 1) -> RunRecord:
    """Return a run with one region of each of these classes in each build."""
    return run_of([overhang(f"overhang {k}", triage) for k, triage in enumerate(triages)], builds)
