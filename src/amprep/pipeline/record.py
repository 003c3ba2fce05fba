"""Turns what the stages returned into the record that reports are made of."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from amprep import __version__
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.host import Host
from amprep.job import Job
from amprep.measures.density import build_density, build_height, support_volume
from amprep.measures.slenderness import measure_slenderness
from amprep.model import Build, Packing, PackingProblem, Part, Unsupported
from amprep.overhangs.unsupported import region_name
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.supporting import SupportedBuild
from amprep.report.record import BuildRecord, OverhangRecord, RunRecord, UnconnectedRecord, UnplacedRecord
from amprep.supports.plan import SupportLayout


def build_record(supported: SupportedBuild) -> BuildRecord:
    """Return the figures of one build; file names and the verdict are added as they come."""
    build, layout = supported.build, supported.layout
    return BuildRecord(
        build=build,
        density=build_density(build),
        height_mm=build_height(build),
        support_volume_mm3=support_volume(build),
        advice=supported.advice,
        removal=supported.removal,
        columns=tuple(measure_slenderness(body) for body in build.supports),
        overhangs=() if layout is None else _overhangs(build, layout),
        red=0 if layout is None else len(layout.red),
        unconnected=() if layout is None else _unconnected(supported, layout),
        shared=() if layout is None else layout.shared,
        notes=() if layout is None else layout.notes,
    )


def run_record(
    job: Job,
    host: Host,
    parts: Sequence[Part],
    builds: Sequence[BuildRecord],
    outputs: OutputFolder,
    packing: Packing,
    unplaced: tuple[UnplacedRecord, ...] = (),
) -> RunRecord:
    """Return the record of a whole run."""
    stale = outputs.stale_builds(len(builds))
    left = [f"{name} is from an earlier run with more builds; it was left alone" for name in stale]
    return RunRecord(
        job=job.name,
        version=__version__,
        seed=job.seed,
        printer=job.printer.name,
        target=job.target,
        objective=job.packing.objective,
        builds=tuple(builds),
        unplaced=unplaced,
        status=packing.status,
        stop_reason=packing.stop_reason,
        bound=packing.bound,
        warnings=(*host.warnings, *left, *_advice(builds)),
        notes=tuple(f"{part.name}: {note}" for part in parts for note in part.notes),
        settings={name: asdict(getattr(job, name)) for name in ("packing", "supports", "cells")},
    )


def _advice(builds: Sequence[BuildRecord]) -> list[str]:
    return [f"{entry.build.settings.build_id}: {words}" for entry in builds for words in entry.advice]


def unplaced_records(
    parts: Sequence[Part], problem: PackingProblem, packing: Packing
) -> tuple[UnplacedRecord, ...]:
    """Return the copies that found no place, and why."""
    items = ((problem.items[entry.item], entry.reason) for entry in packing.unplaced)
    return tuple(UnplacedRecord(parts[item.part].name, item.copy + 1, reason) for item, reason in items)


def _overhangs(build: Build, layout: SupportLayout) -> tuple[OverhangRecord, ...]:
    """Return a record of each overhang region of each part."""
    bare: dict[str, list[Unsupported]] = {}
    for each in build.unsupported:
        bare.setdefault(each.label, []).append(each)
    records = []
    for part, (placed, overhangs) in enumerate(zip(build.parts, layout.overhangs, strict=True)):
        count = len(overhangs.regions)
        own = layout.red_part == part
        red = np.bincount(layout.red_region[own], minlength=count)
        connected = np.bincount(layout.red_region[own & layout.connected], minlength=count)
        for number, region in enumerate(overhangs.regions):
            name = region_name(number, placed.label)
            x, y, z = region.centre.tolist()
            records.append(
                OverhangRecord(
                    name,
                    placed.label,
                    region.kind,
                    z if region.kind == "tip" else region.measure,
                    (x, y, z),
                    int(red[number]),
                    int(connected[number]),
                    _held(region, bare.get(name, ())),
                    tuple(sorted({each.reason for each in bare.get(name, ())})),
                )
            )
    return tuple(records)


def _held(region: OverhangRegion, bare: Sequence[Unsupported]) -> str:
    """Say how much of a region is held, from what is listed of it."""
    if all(each.minor for each in bare):
        return "whole"
    return "part" if sum(each.measure for each in bare) < (1.0 - 1e-6) * region.measure else "not"


def _unconnected(supported: SupportedBuild, layout: SupportLayout) -> tuple[UnconnectedRecord, ...]:
    frame, records = layout.frame, []
    for red in (~layout.connected).nonzero()[0].tolist():
        plane, y, x = (int(value) for value in layout.red[red])
        label = supported.build.parts[int(layout.red_part[red])].label
        records.append(
            UnconnectedRecord(
                label,
                region_name(int(layout.red_region[red]), label),
                layout.reasons[red],
                (plane, y, x),
                (
                    float(frame.origin[0] + (x + 0.5) * frame.pitch),
                    float(frame.origin[1] + (y + 0.5) * frame.pitch),
                    float(frame.origin[2] + plane * frame.step),
                ),
            )
        )
    return tuple(records)
