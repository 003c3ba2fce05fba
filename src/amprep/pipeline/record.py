"""Collect the results of the stages in the records from which reports are made."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace

import numpy as np

from amprep import __version__
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.job import Job
from amprep.measures.bounding_volume import kind_of_volumes
from amprep.measures.density import build_density, build_height, support_volume
from amprep.measures.height_profile import measure_profile
from amprep.measures.legs import measure_legs
from amprep.measures.objective import objective_reached
from amprep.measures.printing.blade_edges import measure_blade_edges
from amprep.measures.printing.estimate import PrintingEstimate, PrintingRates, estimate_printing
from amprep.measures.removal_order import measure_removal_order
from amprep.model import Stop, Unsupported
from amprep.model.counting import counted
from amprep.overhangs.unsupported import region_name
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.packing import PackedParts
from amprep.pipeline.packing.turning import blade_rules
from amprep.pipeline.reading import LoadedParts, warnings_about
from amprep.pipeline.supporting import SupportedBuild, part_densities
from amprep.report.record import (
    BuildRecord,
    OverhangRecord,
    RunRecord,
    ShownVolume,
    UnconnectedSquare,
    UnplacedRecord,
)
from amprep.report.triage.classes import triage_of
from amprep.report.triage.words import region_words
from amprep.supports.plan import SupportLayout


def build_record(supported: SupportedBuild, job: Job, stop: Stop) -> BuildRecord:
    """Return the record of a build, without file names and verification.

    The search for the removal order ends at the stop.
    """
    build, layouts = supported.build, supported.layouts
    return BuildRecord(
        build=build,
        density=build_density(build),
        height_mm=build_height(build),
        support_volume_mm3=support_volume(build),
        advice=supported.advice,
        removal=supported.removal,
        printing=_printing(supported, job),
        blade_edges=() if (rules := blade_rules(job)) is None else measure_blade_edges(build, rules),
        removal_order=measure_removal_order(build, stop),
        profile=measure_profile(build),
        legs=measure_legs(build, min((layout.grid.step for layout in layouts), default=1.0)),
        overhangs=_overhangs(supported),
        demand_squares=sum(len(layout.red.square) for layout in layouts),
        unconnected=tuple(each for layout in layouts for each in _unconnected(supported, layout)),
        shared_supports=tuple(words for layout in layouts for words in layout.shared),
        notes=(*_copy_notes(supported), *(words for layout in layouts for words in layout.notes)),
        rules=supported.rules,
    )


def _copy_notes(supported: SupportedBuild) -> Iterator[str]:
    """Yield a sentence on copies that have the supports of others."""
    copies = supported.copies
    if copies is not None:
        count = len(copies.parts) - len(copies.planned)
        yield (
            f"the supports of {counted(count, 'part')} are those of an equal copy, moved; "
            "the notes on supports count them once"
        )


def _printing(supported: SupportedBuild, job: Job) -> PrintingEstimate:
    """Return mass, use of the plate, hours and cost of a build, from the materials of the job and of its parts."""
    material, build = job.material, supported.build
    rates = PrintingRates(
        job.supports.layer_mm,
        material.recoating_s,
        material.scan_mm2_s,
        material.heating_h,
        material.cooling_h,
        material.hour_price,
        material.powder_price_kg,
    )
    return estimate_printing(build, part_densities(job, build), supported.removal, rates)


def run_record(
    loaded: LoadedParts, packed: PackedParts, builds: Sequence[BuildRecord], outputs: OutputFolder
) -> RunRecord:
    """Return the record of a run.

    Parameters
    ----------
    loaded
        The parts of the job, whose notes the record repeats.
    packed
        Supplies unplaced copies, status, stop reason and bound.
    builds
        Records of all builds.
    outputs
        The output folder; files of an earlier run with more builds are reported.
    """
    job, packing, items = loaded.resolved.job, packed.packing, packed.problem.items
    stale = outputs.stale_builds(len(builds))
    left = [f"{name} is from an earlier run with more builds and was not changed" for name in stale]
    advice = [f"{entry.build.settings.build_id}: {words}" for entry in builds for words in entry.advice]
    unplaced = ((items[entry.item], entry.reason) for entry in packing.unplaced)
    return RunRecord(
        job=job.name,
        version=__version__,
        seed=job.seed,
        printer=job.printer.name,
        target=job.target,
        material=job.material.name,
        objective=job.packing.objective,
        builds=tuple(replace(entry, volumes=_volumes(packed, number)) for number, entry in enumerate(builds)),
        unplaced=tuple(
            UnplacedRecord(loaded.parts[item.part].name, item.copy + 1, why, item.value)
            for item, why in unplaced
        ),
        status=packing.status,
        stop_reason=packing.stop_reason,
        found_by=packing.found_by,
        reached=objective_reached(packed.problem, packing) if packed.problem.items else None,
        bound=packing.bound,
        bound_for=packing.bound_for,
        parts_bound=packed.parts_bound,
        packed_as=kind_of_volumes(item.volume for item in items),
        steps=packing.steps,
        excess=_excess(loaded, packed),
        warnings=(*loaded.resolved.host.warnings, *warnings_about(loaded.parts), *left, *advice),
        notes=(
            *(f"{part.name}: {note}" for part in loaded.parts for note in part.notes),
            *loaded.notes,
            *packed.notes,
            *_unused_rules(job, builds),
        ),
        by_default=tuple(filter(None, [job.default_distances])),
        settings={name: asdict(getattr(job, name)) for name in ("packing", "supports", "cells")},
    )


def _unused_rules(job: Job, builds: Sequence[BuildRecord]) -> tuple[str, ...]:
    """Return a sentence on the ``[[rule]]`` entries that take no region of any build; none without supports."""
    used = frozenset().union(*(entry.rules for entry in builds))
    unused = [str(number) for number in range(1, len(job.rules) + 1) if number not in used]
    if not unused or not job.supports.enabled:
        return ()
    return (
        f"no overhang meets the conditions of [[rule]] {', '.join(unused)}, or earlier entries take them",
    )


def _excess(loaded: LoadedParts, packed: PackedParts) -> dict[str, float]:
    """Return the greatest excess of the convex pieces of each placed part by its name, sorted.

    Surfaces have none, since they have no volume.
    """
    items, found = packed.problem.items, packed.packing.excess
    greatest: dict[str, float] = {}
    for number in (each.item for build in packed.packing.builds for each in build if each.item in found):
        part = loaded.parts[items[number].part]
        if part.is_solid:
            greatest[part.name] = max(found[number], greatest.get(part.name, 0.0))
    return dict(sorted(greatest.items()))


def _volumes(packed: PackedParts, number: int) -> tuple[ShownVolume, ...]:
    """Return the bounding volumes of a build, in the order of its parts; empty if nothing was packed."""
    if number >= len(packed.packing.builds):
        return ()
    placed = sorted(packed.packing.builds[number], key=lambda each: each.item)
    return tuple(
        ShownVolume(index, packed.problem.items[each.item].volume, each.matrix)
        for index, each in enumerate(placed)
    )


def _overhangs(supported: SupportedBuild) -> tuple[OverhangRecord, ...]:
    """Return a record of each overhang of each part, with the red squares of all passes."""
    build, layouts = supported.build, supported.layouts
    unsupported: dict[str, list[Unsupported]] = {}
    for each in build.unsupported:
        unsupported.setdefault(each.label, []).append(each)
    records: list[OverhangRecord] = []
    for part, (placed, (_, found)) in enumerate(zip(build.parts, supported.overhangs, strict=bool(layouts))):
        squares, connected = np.zeros((2, len(found.regions)), np.int64)
        for layout in layouts:
            own = layout.red.part == (part if supported.copies is None else supported.copies.like[part])
            squares += np.bincount(layout.red.region[own], minlength=len(found.regions))
            connected += np.bincount(layout.red.region[own & layout.connected], minlength=len(found.regions))
        own_angle = placed.part.overrides.overhang_angle_deg
        angle = build.settings.rules.overhang_angle_deg if own_angle is None else own_angle
        for number, region in enumerate(found.regions):
            left = unsupported.get(region_name(number, placed.label), ())
            entry = _overhang(region_name(number, placed.label), placed.label, region, left, angle)
            records.append(
                replace(entry, demand_squares=int(squares[number]), connected_squares=int(connected[number]))
            )
    return tuple(records)


def _overhang(
    name: str, part: str, region: OverhangRegion, left: Sequence[Unsupported], angle_deg: float
) -> OverhangRecord:
    """Return the record of a region without its demand squares; `left` is what of it has no support."""
    found = triage_of(region, left, angle_deg)
    x, y, z = region.centre.tolist()
    return OverhangRecord(
        name=name,
        part=part,
        region=region,
        position_mm=(x, y, z),
        verdict=region_words(region, found),
        triage=found.triage,
        supported=found.outcome,
        reasons=tuple(sorted({each.reason for each in left})),
    )


def _unconnected(supported: SupportedBuild, layout: SupportLayout) -> Iterator[UnconnectedSquare]:
    """Yield the unconnected red squares of all parts; those of copies have the place of the square that was planned."""
    grid, copies = layout.grid, supported.copies
    for index in (~layout.connected).nonzero()[0].tolist():
        plane, y, x = (int(value) for value in layout.red.square[index])
        part, region = int(layout.red.part[index]), int(layout.red.region[index])
        alone = [(supported.build.parts[part].label, np.zeros(3))]
        place = grid.origin + np.array([(x + 0.5) * grid.pitch, (y + 0.5) * grid.pitch, plane * grid.step])
        for label, shift in alone if copies is None else copies.of(part):
            x_mm, y_mm, z_mm = (place + shift).tolist()
            yield UnconnectedSquare(
                label, region_name(region, label), layout.reasons[index], (plane, y, x), (x_mm, y_mm, z_mm)
            )
