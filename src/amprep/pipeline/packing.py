"""From parts to builds of placed parts: bounding volumes, the packing problem, labels."""

from collections.abc import Callable, Sequence
from itertools import count

import numpy as np

from amprep.arrays import Floats
from amprep.errors import AmprepError
from amprep.model import (
    BoundingVolume,
    BuildVolume,
    Item,
    Objective,
    Packing,
    PackingProblem,
    Part,
    PlacedPart,
    Placement,
    Progress,
)


def packing_problem(
    parts: Sequence[Part],
    volumes: Sequence[BoundingVolume],
    space: BuildVolume,
    *,
    objective: Objective,
    clearance: float,
    lift: float,
    stacking: bool,
) -> PackingProblem:
    """Return the problem with one item for every copy of every part, in the job's order.

    What the parts say is fixed stands in the first build where it is.
    """
    items = tuple(
        Item(index, copy, volume, part.worth, part.orientations)
        for index, (part, volume) in enumerate(zip(parts, volumes, strict=True))
        for copy in range(part.quantity)
    )
    fixed = tuple(
        Placement(number, np.eye(3), place - parts[item.part].mesh.vertices.min(axis=0))
        for number, item in enumerate(items)
        for place in _places(parts[item.part])[item.copy : item.copy + 1]
    )
    return PackingProblem(
        items, space, objective, fixed=fixed, clearance=clearance, lift=lift, stacking=stacking
    )


def _places(part: Part) -> Floats:
    """Return where the first copies of a part stand already, ``(k, 3)``."""
    return np.empty((0, 3)) if part.fixed is None else part.fixed


def make_volumes(
    parts: Sequence[Part], make: Callable[[Part], BoundingVolume], progress: Progress
) -> list[BoundingVolume]:
    """Return one bounding volume per part; copies share it."""
    volumes = []
    for index, part in enumerate(parts):
        progress(index / len(parts), part.name)
        volumes.append(make(part))
    return volumes


def labels(parts: Sequence[Part]) -> dict[tuple[int, int], str]:
    """Return a name for every copy, unique in the job: ``bracket``, ``bracket-2``, ..."""
    taken = {part.name for part in parts}
    found: dict[tuple[int, int], str] = {}
    for index, part in enumerate(parts):
        found[index, 0] = part.name
        numbers = count(2)
        for copy in range(1, part.quantity):
            label = next(name for n in numbers if (name := f"{part.name}-{n}") not in taken)
            taken.add(label)
            found[index, copy] = label
    return found


def placed_builds(
    parts: Sequence[Part], problem: PackingProblem, packing: Packing
) -> list[tuple[PlacedPart, ...]]:
    """Return the placed parts of every build, in the job's order.

    Raises
    ------
    AmprepError
        If nothing at all was placed.
    """
    if not packing.builds or not any(packing.builds):
        names = sorted({parts[problem.items[entry.item].part].name for entry in packing.unplaced})
        reasons = sorted({entry.reason for entry in packing.unplaced})
        size = " x ".join(f"{value:g}" for value in problem.space.size)
        raise AmprepError(
            f"none of the parts fits the build volume of {size} mm ({', '.join(reasons)}: {', '.join(names[:5])}"
            f"{', ...' if len(names) > 5 else ''}); choose a larger printer, less clearance or lift, or allow rotations"
        )
    names_of = labels(parts)
    builds = []
    for build in packing.builds:
        placed = []
        for placement in sorted(build, key=lambda placement: placement.item):
            item = problem.items[placement.item]
            part = parts[item.part]
            label = names_of[item.part, item.copy]
            placed.append(PlacedPart(label, part, snapped(placement.matrix), part.orientations))
        builds.append(tuple(placed))
    return builds


def snapped(matrix: np.ndarray) -> np.ndarray:
    """Return the matrix as a 3MF keeps it (float32 of six decimals): what is planned is what is written."""
    return np.round(matrix, 6).astype(np.float32).astype(np.float64)
