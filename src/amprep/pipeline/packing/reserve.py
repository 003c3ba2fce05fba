"""Reserve room in a packing for supports that need more than half the clearance beside their part."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import Floats
from amprep.checks.packing.volumes_placed import check_packing
from amprep.job import Job
from amprep.model import Item, Orientations, Packing, PackingProblem, Part, Placement, Stop
from amprep.overhangs.known import KnownOverhangs
from amprep.pipeline.packing.placing import placed_part
from amprep.repacking.widening import widened
from amprep.supports.grid.territory import margin_of
from amprep.supports.room import needed_margin

SAME = 1e-6
"""Difference of the components of directions up to which they are the same."""


@dataclass(frozen=True, eq=False)
class Reserve:
    """Room that the supports of a part need in one orientation.

    Attributes
    ----------
    margin, own
        Margin of the territory that is needed, and the one that the part has, mm.
    rotation
        ``(3, 3)`` rotation of the bounding volume of the part in the build.
    """

    margin: float
    own: float
    rotation: Floats


def find_reserves(
    parts: Sequence[Part],
    problem: PackingProblem,
    packing: Packing,
    job: Job,
    overhangs: KnownOverhangs,
    stop: Stop,
) -> dict[int, Reserve]:
    """Return the room that parts of a packing need beyond their margin, by the number of the part.

    Parts with a fixed position get none, nor do parts that may be above one another.

    Parameters
    ----------
    parts
        Parts of the job.
    problem, packing
        The problem, and a packing of it.
    job
        Its rules for supports.
    overhangs
        Finds the overhangs of the parts, once for each orientation.
    stop
        Ends the estimates early; parts that are left get no room.
    """
    found: dict[int, Reserve] = {}
    if not job.supports.enabled or job.supports.territory != "own" or problem.stacking:
        return found
    turned: dict[tuple[int, bytes], tuple[Item, Placement]] = {}
    for placement in (each for build in packing.builds for each in build):
        item = problem.items[placement.item]
        if parts[item.part].fixed is None:
            turned.setdefault((item.part, placement.rotation.tobytes()), (item, placement))
    placed = [
        placed_part(parts[item.part].name, parts[item.part], item, each) for item, each in turned.values()
    ]
    overhangs.find(placed, stop)
    for part, (item, placement) in zip(placed, turned.values(), strict=True):
        if stop():
            break
        own = margin_of(part, job.supports)
        margin = needed_margin(part, overhangs.of(part), job.supports)
        if margin > max(own, found[item.part].margin if item.part in found else 0.0):
            found[item.part] = Reserve(margin, own, placement.rotation)
    return found


def with_room(
    parts: Sequence[Part], problem: PackingProblem, reserves: Mapping[int, Reserve]
) -> tuple[tuple[Part, ...], PackingProblem]:
    """Return the parts with their margins, and the problem with wider volumes for these parts.

    They keep the direction that is up in the packing for which the room was estimated.
    """
    volumes = {item.part: item.volume for item in problem.items if item.part in reserves}
    wider = {
        part: widened(volume, reserves[part].rotation, reserves[part].margin - reserves[part].own)
        for part, volume in volumes.items()
    }
    items = tuple(
        replace(
            item,
            volume=wider[item.part],
            orientations=_with_same_up(item.orientations, reserves[item.part].rotation),
            exact=False,
        )
        if item.part in reserves
        else item
        for item in problem.items
    )
    changed = tuple(
        replace(part, overrides=replace(part.overrides, territory_margin_mm=reserves[number].margin))
        if number in reserves
        else part
        for number, part in enumerate(parts)
    )
    return changed, replace(problem, items=items)


def has_room(problem: PackingProblem, packing: Packing) -> bool:
    """Tell whether a packing is one of the wider volumes too: then the parts have their room where they are."""
    return not check_packing(problem, packing)


def room_notes(parts: Sequence[Part], reserves: Mapping[int, Reserve], *, kept: bool) -> tuple[str, ...]:
    """Return a sentence on the parts that got room, or that found none."""
    if not reserves:
        return ()
    names = [f"{parts[number].name} {reserves[number].margin:.1f} mm" for number in sorted(reserves)]
    if kept:
        return (f"no other part may stand in the room that supports need beside parts: {', '.join(names)}",)
    return (
        f"supports need more room than there is beside parts, but with it fewer parts would fit: {', '.join(names)}",
    )


def is_as_good(packing: Packing, other: Packing) -> bool:
    """Tell whether a packing has no more builds and leaves no more items unplaced than another."""
    return len(packing.builds) <= len(other.builds) and len(packing.unplaced) <= len(other.unplaced)


def _with_same_up(orientations: Orientations, rotation: Floats) -> Orientations:
    """Return the orientations with the same direction up as a rotation."""
    if orientations.freedom == "about-z":
        return orientations
    if orientations.freedom == "free":
        return Orientations("list", rotation[None])
    same = np.abs(orientations.matrices[:, 2] - rotation[2]).max(axis=1) < SAME
    return replace(orientations, matrices=orientations.matrices[same])
