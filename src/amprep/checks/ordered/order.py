"""Judge whether a build is what a job orders: its printer, its settings, its parts and their number."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.checks.ordered.weaker import (
    Weaker,
    most_lenient,
    weaker_orientations,
    weaker_part,
    weaker_settings,
)
from amprep.checks.packing.parts_placed import ROUNDING
from amprep.checks.violation import Violation
from amprep.model.build import Build, BuildSettings, PlacedPart, SupportBody
from amprep.model.build_volume import BuildVolume
from amprep.model.counting import counted
from amprep.model.part import Part

PROMISE = "as ordered"
"""Name of the promise."""


@dataclass(frozen=True, eq=False)
class Order:
    """What was ordered.

    Attributes
    ----------
    source
        What states the order, for messages: the name of a job file or of a printer.
    settings
        The settings that the build must be judged by.
    parts
        The parts of the job with their quantities; None if only the printer is ordered.
    """

    source: str
    settings: BuildSettings
    parts: tuple[Part, ...] | None = None


def check_order(build: Build, order: Order) -> list[Violation]:
    """Return in what a build differs from an order: weaker settings, another build volume, other parts, more copies.

    Fewer copies than ordered are no violation, because a job may have several builds.
    """
    found = [*_volume(build.settings.space, order), *_origin(build.settings, order)]
    found += [_violation("settings", each) for each in weaker_settings(most_lenient(build), order.settings)]
    if order.parts is None:
        return found
    ordered = [ordered_part(placed.part, order.parts) for placed in build.parts]
    for placed, part in zip(build.parts, ordered, strict=True):
        if part is None:
            message = f"no part of {order.source} has its geometry"
            found.append(Violation(PROMISE, placed.label, message))
        else:
            found += [_violation("settings", each) for each in _weaker(placed, part, order)]
    copies = Counter(part.name for part in ordered if part is not None)
    for each in order.parts:
        if copies[each.name] > each.quantity:
            message = f"{counted(copies[each.name], 'copy', 'copies')} in the build, {each.quantity} ordered"
            found.append(Violation(PROMISE, each.name, message))
    return found


def as_ordered(build: Build, order: Order) -> Build:
    """Return a build with the settings, and for its parts with the rules, of an order, so that it is judged by them.

    A smaller reach of the file stays, because the ordered one is that of the widest pass. Supports lose a reach and
    sizes of their own that are more lenient than ordered.
    """
    own, due = build.settings, order.settings
    reach = min(own.reach, due.reach)
    settings = replace(due, build_id=own.build_id, target=own.target, reach=reach)
    supports = tuple(_ordered_support(body, due) for body in build.supports)
    parts = build.parts
    if order.parts is not None:
        known = order.parts
        parts = tuple(_ordered_placed(placed, ordered_part(placed.part, known)) for placed in parts)
    return replace(build, settings=settings, parts=parts, supports=supports)


def _ordered_support(body: SupportBody, due: BuildSettings) -> SupportBody:
    """Return a support without what is more lenient than ordered."""
    own = replace(due, reach=due.reach_of(body), sizes=due.sizes_of(body))
    return replace(body, reach=None, sizes=None) if weaker_settings(own, due) else body


def ordered_part(built: Part, parts: Sequence[Part]) -> Part | None:
    """Return the part with the geometry of a part in a build, to the rounding of build files; None if there is none.

    Of several, it is one with the same name, if there is one.
    """
    mesh = built.mesh
    for part in sorted(parts, key=lambda each: each.name != built.name):
        known = part.mesh
        if known.triangles.shape != mesh.triangles.shape or known.vertices.shape != mesh.vertices.shape:
            continue
        is_near = np.abs(known.vertices - mesh.vertices).max(initial=0.0) <= ROUNDING
        if is_near and np.array_equal(known.triangles, mesh.triangles):
            return part
    return None


def _weaker(placed: PlacedPart, part: Part, order: Order) -> list[Weaker]:
    found = weaker_part(placed.label, placed.part.overrides, part.overrides, order.settings)
    found += weaker_orientations(placed.label, placed.orientations, part.orientations)
    if part.is_solid and not placed.part.is_solid:
        found.append(Weaker(f"{placed.label}: is_solid", False, True))
    return found


def _ordered_placed(placed: PlacedPart, part: Part | None) -> PlacedPart:
    """Return a placed part with the rules of the ordered one; its geometry stays that of the file."""
    if part is None:
        return placed
    judged = replace(part, mesh=placed.part.mesh)
    return replace(placed, part=judged, orientations=part.orientations)


def _violation(subject: str, each: Weaker) -> Violation:
    return Violation(PROMISE, subject, each.words("ordered"))


def _origin(own: BuildSettings, order: Order) -> list[Violation]:
    """Return a violation if the file has the corner of the plate elsewhere than the ordered printer."""
    due = order.settings.plate_origin
    if np.abs(np.subtract(own.plate_origin, due)).max() <= ROUNDING:
        return []
    places = [f"({x:g}, {y:g})" for x, y in (own.plate_origin, due)]
    message = f"the corner of the plate is at {places[0]} mm, ordered {places[1]} mm"
    return [Violation(PROMISE, "build volume", message)]


def _volume(space: BuildVolume, order: Order) -> list[Violation]:
    """Return a violation if the build volume of the file is larger than the ordered one, or lacks its zones."""
    due = order.settings.space
    if (np.asarray(space.size) > np.asarray(due.size) + ROUNDING).any() or space.shape != due.shape:
        sizes = [" x ".join(f"{side:g}" for side in each.size) for each in (space, due)]
        message = f"{space.shape} of {sizes[0]} mm, ordered {due.shape} of {sizes[1]} mm"
        return [Violation(PROMISE, "build volume", message)]
    zones = np.hstack([space.zone_lo, space.zone_hi])
    for zone in np.hstack([due.zone_lo, due.zone_hi]):
        if not (np.abs(zones - zone) <= ROUNDING).all(axis=1).any():
            return [Violation(PROMISE, "build volume", "it lacks a forbidden zone of the ordered printer")]
    return []
