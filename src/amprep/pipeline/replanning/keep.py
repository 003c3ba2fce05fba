"""Decide which supports of an edited build still hold, and why the others are planned again."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.checks.neighbours.apart import check_apart
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.supports.territory import check_territory
from amprep.checks.supports.xy_distance import check_xy_distance
from amprep.checks.violation import Violation
from amprep.model import Build, BuildSettings, Stop, SupportBody, Unsupported
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME, TERRITORY
from amprep.pipeline.replanning.records import EditedBuild, EditedPart
from amprep.pipeline.verifying.nearby import are_near, boxes_in_plan, distance_that_matters, nearby

# Strategy. Supports can stay if their parts did not move, or moved along the plate with them, all together. What can
# have changed for them is what is near. So the judges look at those supports that moved, or near which something moved,
# came or went, at their new places. Overhangs that are listed may have a way to the plate now, so their parts are
# planned again if something near them changed.


_REASONS_OF_OTHERS = (ENCLOSED, TERRITORY, CAPACITY, OUT_OF_TIME)
"""Reasons that may no longer hold when other parts move; the others follow from the part itself."""
_MOST_NAMED = 3
"""Settings that a reason names."""


class Kept(NamedTuple):
    """The supports that stay, and the parts whose supports are planned again.

    Attributes
    ----------
    supports
        The supports that stay.
    reasons
        For each part that is planned again, by its index, why.
    """

    supports: tuple[SupportBody, ...]
    reasons: dict[int, str]


def choose_kept(edited: EditedBuild, original: Build, stop: Stop, other_settings: Sequence[str] = ()) -> Kept:
    """Return which supports stay.

    Parameters
    ----------
    edited
        The build as it is now, whose parts are apart and inside the build volume.
    original
        The build as it was written; without supports if they are not known.
    stop
        Ends the judges early.
    other_settings
        Names of the settings by which its supports were not planned; if there are any, none is kept.
    """
    if not original.settings.supported:
        return Kept((), {})
    if other_settings:
        return Kept((), dict.fromkeys(range(len(edited.parts)), _other_words(other_settings)))
    moved = _surroundings_changed(edited, original)
    reasons = {
        number: reason
        for number, each in enumerate(edited.parts)
        if (reason := _own_reason(each, number, edited, original, bool(moved[number])))
    }
    supports = _drop_shared(edited.supports, reasons, edited)
    for body, message in _refused(edited, original.settings, supports, moved, stop):
        for part in body.parts:
            reasons.setdefault(part, f"its supports do not fit here: {message}")
    return Kept(_drop_shared(supports, reasons, edited), reasons)


def _other_words(names: Sequence[str]) -> str:
    """Return that the job has other settings, with a few of their names as a job file has them."""
    keys = [name.rpartition(".")[2] for name in names]
    more = f" and {len(keys) - _MOST_NAMED} more" if len(keys) > _MOST_NAMED else ""
    return f"the job has another {', '.join(keys[:_MOST_NAMED])}{more}"


def _own_reason(
    each: EditedPart, number: int, edited: EditedBuild, original: Build, surroundings_changed: bool
) -> str:
    """Return why a part is planned again whatever its supports are like; empty if there is no such reason."""
    if each.was is None or each.change == "added":
        return "added"
    if not each.slides:
        return "turned" if each.change == "turned" else "at another height or in another orientation"
    had = [index for index, body in enumerate(original.supports) if each.was in body.parts]
    has = [
        source for body, source in zip(edited.supports, edited.sources, strict=True) if number in body.parts
    ]
    if sorted(has) != had:
        return "its supports are not in the file as they were planned"
    listed = [region for region in original.unsupported if region.part == each.was]
    if surroundings_changed and any(_may_change(region) for region in listed):
        return "something near its unsupported overhangs changed"
    return ""


def _may_change(region: Unsupported) -> bool:
    return region.reason in _REASONS_OF_OTHERS and not region.minor


def _drop_shared(
    supports: Sequence[SupportBody], reasons: dict[int, str], edited: EditedBuild
) -> tuple[SupportBody, ...]:
    """Return the supports of parts that are not planned again; parts that share a support with such a part join it."""
    left = list(supports)
    while dropped := [body for body in left if any(part in reasons for part in body.parts)]:
        left = [body for body in left if body not in dropped]
        for body in dropped:
            cause = next(part for part in body.parts if part in reasons)
            for part in body.parts:
                reasons.setdefault(part, f"shares supports with {edited.parts[cause].placed.label}")
    return tuple(left)


def _surroundings_changed(edited: EditedBuild, original: Build) -> Bools:
    """Tell for each part whether it, or something near it, moved, came or went."""
    settings = original.settings
    placed = [each.placed for each in edited.parts]
    distance = distance_that_matters(settings, [*placed, *original.parts])
    now, then = boxes_in_plan(placed), boxes_in_plan(original.parts)
    changed = np.array([each.change != "none" for each in edited.parts])
    there = {each.was for each in edited.parts if each.change == "none"}
    gone = np.array([index not in there for index in range(len(original.parts))], np.bool_)
    result = changed.copy()
    for number, box in enumerate(now):
        result[number] |= (
            are_near(now[changed], box, distance).any() or are_near(then[gone], box, distance).any()
        )
    return result


def _refused(
    edited: EditedBuild, settings: BuildSettings, supports: Sequence[SupportBody], moved: Bools, stop: Stop
) -> list[tuple[SupportBody, str]]:
    """Return the supports that judges refuse at their new places, and why; of two, those that moved."""
    in_order = sorted(supports, key=lambda body: not any(_moved(edited, part) for part in body.parts))
    build = Build(settings, tuple(each.placed for each in edited.parts), tuple(in_order))
    chosen = {part for body in in_order if moved[list(body.parts)].any() for part in body.parts}
    if not chosen:
        return []
    near, solids = nearby(build, chosen), KnownSolids()
    found: list[Violation] = [
        *check_bodies(near, stop, solids),
        *check_xy_distance(near, stop),
        *check_territory(near, stop, solids),
        *check_apart(build, stop, solids),
    ]
    by_name = {body.name: body for body in in_order}
    return [(by_name[each.subject], each.message) for each in found if each.subject in by_name]


def _moved(edited: EditedBuild, part: int) -> bool:
    return edited.parts[part].change != "none"
