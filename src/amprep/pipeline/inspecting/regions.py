"""Explain the overhang regions of parts: verdicts, and the rules of the job that take them; nothing is planned."""

from dataclasses import fields
from typing import Any

import numpy as np

from amprep.errors import JobError, nearest_hint
from amprep.job.settings.rules import RuleSettings
from amprep.model import Part, PlacedPart
from amprep.overhangs.conditions import RegionConditions, is_named
from amprep.overhangs.unsupported import region_name
from amprep.overhangs.verdicts import verdict_words
from amprep.pipeline.passes import take_regions
from amprep.pipeline.reading import LoadedParts, read_job
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock, Watcher
from amprep.pipeline.support_plate import place_as_read
from amprep.report.regions import SELF_SUPPORTING, ExplainedRegion, RegionsRecord
from amprep.threemf.transforms import round_as_stored


def explain_regions(
    resolved: ResolvedJob,
    pattern: str,
    *,
    center: bool = False,
    allow_surface: bool = False,
    watcher: Watcher,
) -> RegionsRecord:
    """Find the overhang regions of the parts that a pattern names, and say what takes each.

    Parts are at their positions in the file, as `amprep support` supports them. Without `center` a part that reaches
    below the plate is raised to the lift of the job.

    Parameters
    ----------
    resolved
        Job with the offers that it names.
    pattern
        Name of parts or of their files, with ``*`` and ``?``.
    center
        Whether all parts together are first moved to the middle of the plate and onto it.
    allow_surface
        Whether meshes that are not solids are accepted as surfaces.
    watcher
        Shows the progress.

    Raises
    ------
    JobError
        When no part has that name.
    AmprepError
        For wrong input.
    """
    clock = Clock(watcher)
    loaded = read_job(resolved, clock, allow_surface=allow_surface)
    parts, lift = loaded.parts, resolved.job.packing.lift_mm
    chosen = [index for index, part in enumerate(parts) if is_named(part, pattern)]
    if not chosen:
        raise JobError(f"no part is called {pattern!r}{nearest_hint(pattern, [part.name for part in parts])}")
    with clock.stage("overhangs"):
        lying = _in_the_middle(loaded) if center else [_placed(part, lift) for part in parts]
        regions = [each for index in chosen for each in _regions_of(resolved, parts[index], lying[index])]
    return RegionsRecord(resolved.job.name, tuple(regions))


def _regions_of(resolved: ResolvedJob, part: Part, placed: PlacedPart) -> list[ExplainedRegion]:
    taken = take_regions(resolved, [placed])
    (own,), (rules,) = taken.overhangs, taken.rules
    return [
        ExplainedRegion(
            name=region_name(number, placed.label),
            part=part.name,
            kind=region.kind,
            size_mm=region.size_mm,
            angle_deg=region.angle_deg,
            height_mm=region.lowest_mm,
            centre_mm=(float(region.centre[0]), float(region.centre[1]), float(region.centre[2])),
            measure=region.measure,
            verdict=verdict_words(region),
            rule=SELF_SUPPORTING if region.is_self_supporting else f"[[rule]] {rule}" if rule else "default",
            settings=_words(resolved.job.rules[rule - 1]) if rule and not region.is_self_supporting else "",
        )
        for number, (region, rule) in enumerate(zip(own.overhangs.regions, rules.tolist(), strict=True))
    ]


def _in_the_middle(loaded: LoadedParts) -> list[PlacedPart]:
    """Return the first copy of each part as `amprep support --center` places it."""
    placed = place_as_read(loaded, center=True).parts
    first = np.cumsum([0, *(len(part.origins) for part in loaded.parts)])[:-1]
    return [placed[index] for index in first.tolist()]


def _placed(part: Part, lift: float) -> PlacedPart:
    matrix = np.eye(4)
    matrix[:3, 3] = part.origins[0]
    lowest = float(part.mesh.bounds[0][2] + matrix[2, 3])
    if lowest < 0.0:
        matrix[2, 3] += lift - lowest
    return PlacedPart(part.name, part, round_as_stored(matrix))


def _words(rule: RuleSettings) -> str:
    """Return the settings of a rule without its conditions: ``connector = teeth, pitch_mm = 1``."""
    conditions = {each.name for each in fields(RegionConditions)}
    given = ((each.name, getattr(rule, each.name)) for each in fields(rule) if each.name not in conditions)
    return ", ".join(f"{name} = {_shown(value)}" for name, value in given if _is_given(value))


def _is_given(value: Any) -> bool:
    return value is not None and value is not True and value != {}


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)
