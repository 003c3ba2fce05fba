"""Plan the supports of some parts of a build again, around the supports that are kept."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.model import Build, PlacedPart, Stop, SupportBody, Unsupported
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.replanning.keep import Kept
from amprep.pipeline.replanning.records import EditedBuild
from amprep.pipeline.resolve import ResolvedJob
from amprep.pipeline.stages import Clock
from amprep.pipeline.supporting import support_build
from amprep.pipeline.verifying.nearby import are_near, as_obstacle, boxes_in_plan, distance_that_matters


def plan_again(
    edited: EditedBuild,
    kept: Kept,
    original: Build,
    resolved: ResolvedJob,
    name: str,
    clock: Clock,
    stop: Stop,
) -> Build:
    """Return the new build: supports that are kept, and new ones for the other parts.

    Parameters
    ----------
    edited, kept
        The parts where they are now, and the supports that stay.
    original
        The build as it was written, with the settings of the new one.
    resolved
        The job by which supports are planned.
    name
        Name of the new build.
    clock
        Times and shows the stages ``route``, ``cells`` and ``judge``.
    stop
        Ends the routing early with the best result so far.
    """
    parts = tuple(each.placed for each in edited.parts)
    settings = replace(original.settings, build_id=name)
    supports, listed = list(kept.supports), _listed(edited, kept, original)
    if kept.reasons:
        again, numbers = _part_of_build(parts, kept, original, resolved, name)
        made = support_build(again, clock, stop).build
        supports += [_numbered(body, numbers, made, original) for body in made.supports]
        listed += [replace(region, part=numbers[region.part]) for region in made.unsupported]
    return Build(
        settings,
        parts,
        tuple(sorted(supports, key=lambda body: body.parts)),
        tuple(sorted(listed, key=lambda region: region.part)),
    )


def _numbered(body: SupportBody, numbers: Sequence[int], made: Build, original: Build) -> SupportBody:
    """Return a new support with the parts of the whole build; it states other reach and sizes."""
    own = made.settings
    body = replace(body, parts=tuple(numbers[each] for each in body.parts))
    if body.reach is None and own.reach != original.settings.reach:
        body = replace(body, reach=own.reach)
    if body.sizes is None and own.sizes != original.settings.sizes:
        body = replace(body, sizes=own.sizes)
    return body


def _part_of_build(
    parts: Sequence[PlacedPart], kept: Kept, original: Build, resolved: ResolvedJob, name: str
) -> tuple[PackedBuild, list[int]]:
    """Return the parts to plan again with what is near them, and their indices in the build."""
    boxes, distance = boxes_in_plan(parts), distance_that_matters(original.settings, parts)
    near = np.zeros(len(parts), np.bool_)
    for each in kept.reasons:
        near |= are_near(boxes, boxes[each], distance)
    numbers = np.flatnonzero(near).tolist()
    chosen = tuple(parts[each] if each in kept.reasons else as_obstacle(parts[each]) for each in numbers)
    around = tuple(body for body in kept.supports if near[list(body.parts)].any())
    return PackedBuild(resolved, 1, name, chosen, kept=around), numbers


def _listed(edited: EditedBuild, kept: Kept, original: Build) -> list[Unsupported]:
    """Return the listed overhangs of the parts that are not planned again, where these are now."""
    found = []
    for number, each in enumerate(edited.parts):
        if number in kept.reasons or each.was is None:
            continue
        before = original.parts[each.was].label
        for region in original.unsupported:
            if region.part == each.was:
                label = f"{region.label.removesuffix(before)}{each.placed.label}"
                moved = region.points + each.motion[:3, 3]
                found.append(replace(region, part=number, label=label, points=moved))
    return found


def bodies_of(build: Build, part: int) -> list[SupportBody]:
    """Return the supports that hold a part."""
    return [body for body in build.supports if part in body.parts]
