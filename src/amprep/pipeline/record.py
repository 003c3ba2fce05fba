"""Turns what the stages returned into the record that reports are made of."""

from collections.abc import Sequence
from dataclasses import asdict

from amprep import __version__
from amprep.host import Host
from amprep.job import Job
from amprep.model import Packing, PackingProblem, Part
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.supported import SupportedBuild
from amprep.pipeline.supports import SupportLayout
from amprep.report.measures import build_density, build_height, support_volume
from amprep.report.record import BuildRecord, RunRecord, UnconnectedRecord, UnplacedRecord


def build_record(supported: SupportedBuild) -> BuildRecord:
    """Return the figures of one build; file names and the verdict are added as they come."""
    build, layout = supported.build, supported.layout
    return BuildRecord(
        build=build,
        density=build_density(build),
        height_mm=build_height(build),
        support_volume_mm3=support_volume(build),
        red=0 if layout is None else len(layout.red),
        unconnected=() if layout is None else _unconnected(supported, layout),
        shared=() if layout is None else layout.notes,
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
        warnings=(*host.warnings, *left),
        notes=tuple(f"{part.name}: {note}" for part in parts for note in part.notes),
        settings={name: asdict(getattr(job, name)) for name in ("packing", "supports", "cells")},
    )


def unplaced_records(
    parts: Sequence[Part], problem: PackingProblem, packing: Packing
) -> tuple[UnplacedRecord, ...]:
    """Return the copies that found no place, and why."""
    items = ((problem.items[entry.item], entry.reason) for entry in packing.unplaced)
    return tuple(UnplacedRecord(parts[item.part].name, item.copy + 1, reason) for item, reason in items)


def _unconnected(supported: SupportedBuild, layout: SupportLayout) -> tuple[UnconnectedRecord, ...]:
    frame, records = layout.frame, []
    for red in (~layout.connected).nonzero()[0].tolist():
        plane, y, x = (int(value) for value in layout.red[red])
        label = supported.build.parts[int(layout.red_part[red])].label
        records.append(
            UnconnectedRecord(
                label,
                f"overhang {int(layout.red_region[red]) + 1} of {label}",
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
