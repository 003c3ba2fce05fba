"""The first layout: a packing by another packer, of enclosing boxes or of the shapes themselves."""

from dataclasses import replace
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from amprep.measures.bounding_volume import points_of
from amprep.model.bounding_volume import Boxes
from amprep.model.control import Stop, silent
from amprep.model.packing import Item, Packing, PackingProblem, Placement, Unplaced
from amprep.model.part import Orientations
from amprep.model.rotations import axis_rotations, quarter_turns
from amprep.plugins.packers.params import AutoParams, ExtremePointsParams, SeparationParams, SweepParams


class BoxStart(NamedTuple):
    """Function and parameters of a packer of boxes that makes a first layout."""

    where: str
    params: Any


_PACKERS = {
    "extreme-points": BoxStart("extreme_points:pack_extreme_points", ExtremePointsParams()),
    "auto": BoxStart("auto:pack_auto", AutoParams(work=5.0, proof=0.0)),
    "sweep": BoxStart("sweep:pack_sweep", SweepParams()),
}

SHARE = 0.75
"""Fraction of the time that is left for a first layout by `separation`, which prepares the shapes first."""

SEPARATION = SeparationParams(work=3000.0, failures=20)
"""Parameters of a first layout by `separation`."""

RESERVE = 2e-3
"""Clearance (mm) that is added where the first layout is too tight: packers of boxes let them overlap by 1e-3 mm."""


def start_layout(
    problem: PackingProblem, name: str, rng: np.random.Generator, stop: Stop, reserve: float = 0.0
) -> Packing:
    """Return a packing of the items or of their enclosing boxes; for ``outside`` no item is placed.

    Parameters
    ----------
    problem
        Problem with any volumes and orientations.
    name
        One of `params.STARTS`.
    rng, stop
        As for any packer.
    reserve
        Clearance that is added, mm.
    """
    if name == "outside":
        fixed = {placement.item for placement in problem.fixed}
        left = (number for number in range(len(problem.items)) if number not in fixed)
        builds = (problem.fixed,) if problem.fixed else ()
        return Packing(builds, tuple(Unplaced(number, "no room left") for number in left))
    if name == "separation":
        return _separated(problem, rng, stop, reserve)
    module, _, function = _PACKERS[name].where.partition(":")
    pack = getattr(import_module(f"amprep.plugins.packers.{module}"), function)
    packing: Packing = pack(
        box_problem(problem, reserve), params=_PACKERS[name].params, rng=rng, stop=stop, progress=silent
    )
    return packing if problem.stacking else _lowered(problem, packing)


def _lowered(problem: PackingProblem, packing: Packing) -> Packing:
    """Return a packing of boxes with all volumes down at the lift, above which they may be in tilted boxes."""
    fixed = {placement.item for placement in problem.fixed}

    def lowered(placed: Placement) -> Placement:
        if placed.item in fixed:
            return placed
        lowest = (points_of(problem.items[placed.item].volume) @ placed.rotation[2]).min()
        return replace(placed, translation=np.array([*placed.translation[:2], problem.lift - lowest]))

    return replace(packing, builds=tuple(tuple(map(lowered, build)) for build in packing.builds))


def _separated(problem: PackingProblem, rng: np.random.Generator, stop: Stop, reserve: float) -> Packing:
    """Return a packing of the shapes themselves by `separation`.

    Without stacking, which it needs, and where its time is too short for all items, return one of boxes.
    """
    if not problem.stacking:
        return start_layout(problem, "extreme-points", rng, stop, reserve)
    from amprep.plugins.packers.separation import pack_separation

    items = tuple(replace(item, orientations=listed(item.orientations)) for item in problem.items)
    shaped = replace(problem, items=items, clearance=problem.clearance + reserve)
    part = stop.within(SHARE * stop.remaining()) if np.isfinite(stop.remaining()) else stop
    packing = pack_separation(shaped, params=SEPARATION, rng=rng, stop=part, progress=silent)
    if any(unplaced.reason == "out of time" for unplaced in packing.unplaced):
        return start_layout(problem, "extreme-points", rng, stop, reserve)
    return packing


def box_problem(problem: PackingProblem, reserve: float = 0.0) -> PackingProblem:
    """Return the problem with enclosing boxes and lists of orientations; `height` becomes `fill`.

    Of packings of equal value, the packers of boxes prefer low ones.
    """
    known: dict[int, Boxes] = {}
    items = []
    for item in problem.items:
        boxes = known.setdefault(id(item.volume), _enclosing(item))
        value = (
            float(np.prod(boxes.hi - boxes.lo, axis=1).sum()) if problem.objective == "height" else item.value
        )
        items.append(replace(item, volume=boxes, value=value, orientations=listed(item.orientations)))
    objective = "fill" if problem.objective == "height" else problem.objective
    return replace(problem, items=tuple(items), objective=objective, clearance=problem.clearance + reserve)


def listed(orientations: Orientations) -> Orientations:
    """Return a list of orientations: quarter turns for any angle about z, 24 rotations for any rotation."""
    lists = {"about-z": quarter_turns, "free": axis_rotations}
    if orientations.freedom == "list":
        return orientations
    return Orientations("list", lists[orientations.freedom]())


def _enclosing(item: Item) -> Boxes:
    return item.volume if isinstance(item.volume, Boxes) else Boxes(*item.volume.enclosing())


def placements(packing: Packing, build: int) -> dict[int, Placement]:
    """Return the placements of a build by item; none if there is no such build."""
    return {p.item: p for p in packing.builds[build]} if build < len(packing.builds) else {}
