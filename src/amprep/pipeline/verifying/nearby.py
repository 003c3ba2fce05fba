"""Cut some parts of a build out, with what is near them, so that their supports are judged without all the others."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.model import Build, BuildSettings, PlacedPart, SupportBody

_MORE_MM = 1.0
"""Added to the distance (mm) within which parts and supports matter to each other."""


def distance_that_matters(settings: BuildSettings, parts: Sequence[PlacedPart]) -> float:
    """Return the distance in plan (mm) of parts beyond which neither parts nor their supports matter to each other.

    It is infinite where supports may be anywhere.
    """
    rules = settings.rules
    if rules.territory == "shared":
        return float("inf")
    own = [each.part.overrides for each in parts]
    clearances = [settings.clearance, *(each.clearance_mm or 0.0 for each in own)]
    margins = [rules.territory_margin_mm, *(each.territory_margin_mm or 0.0 for each in own)]
    reserve = 2.0 * max(margins) + settings.sizes.base_margin_mm + rules.gap_mm
    return max(*clearances, reserve) + 2.0 * settings.sizes.square_mm + _MORE_MM


def boxes_in_plan(parts: Sequence[PlacedPart]) -> Floats:
    """Return the least and greatest corners ``(n, 2, 2)`` mm of parts in plan."""
    return np.array([[bound[:2] for bound in each.mesh.bounds] for each in parts]).reshape(-1, 2, 2)


def are_near(boxes: Floats, box: Floats, distance: float) -> Bools:
    """Tell which boxes ``(n, 2, 2)`` mm are within a distance of a box ``(2, 2)`` along both axes."""
    near: Bools = ((boxes[:, 0] <= box[1] + distance) & (boxes[:, 1] >= box[0] - distance)).all(axis=1)
    return near


def nearby(build: Build, chosen: Collection[int]) -> Build:
    """Return some parts of a build with their supports, and the parts near them without any.

    The parts near them need no support, and their regions are left out.

    Parameters
    ----------
    build
        The build.
    chosen
        Indices of its parts; if one shares a support with others, these must be among them.
    """
    boxes = boxes_in_plan(build.parts)
    distance = distance_that_matters(build.settings, build.parts)
    near = np.zeros(len(build.parts), np.bool_)
    for each in chosen:
        near |= are_near(boxes, boxes[each], distance)
    indices = np.flatnonzero(near).tolist()
    number = {old: new for new, old in enumerate(indices)}
    return Build(
        build.settings,
        tuple(build.parts[each] if each in chosen else as_obstacle(build.parts[each]) for each in indices),
        tuple(_numbered(body, number) for body in build.supports if set(body.parts) <= set(chosen)),
        tuple(replace(each, part=number[each.part]) for each in build.unsupported if each.part in chosen),
    )


def as_obstacle(placed: PlacedPart) -> PlacedPart:
    """Return a part that needs no support."""
    overrides = replace(placed.part.overrides, supports=False)
    return replace(placed, part=replace(placed.part, overrides=overrides, regions=()))


def _numbered(body: SupportBody, number: dict[int, int]) -> SupportBody:
    return replace(body, parts=tuple(number[each] for each in body.parts))
