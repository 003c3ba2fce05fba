"""Take parts that are locked into each other out of a packing, and put them where they can be taken out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.boxes.footprint import convex_outline
from amprep.geometry.removal.blocking import Blocking
from amprep.geometry.removal.bodies import MovableBody
from amprep.geometry.removal.insertion import box_drops, drop
from amprep.geometry.removal.order import DIRECTIONS, find_removal_order
from amprep.measures.objective import objective_reached
from amprep.model import Item, Packing, PackingProblem, Placement, Stop, Unplaced
from amprep.repacking.volume_bodies import VolumeBodies

# Strategy. A packing of one box per part, parallel to the axes, has no locked groups: the box with the highest lower
# face is below no other, and leaves upwards. In other packings, the smallest part of each locked group is taken out
# until no group is locked. Each part that was taken out is let down from above, beside and on the others, at the
# positions of a grid and beside the boxes of others, where it comes to rest lowest. What comes in from above last can
# leave upwards first; so the order of the others stays possible. Bounding volumes contain their parts, which therefore
# can leave as well.

GRID = 8
"""Positions along x and along y that are tried, besides those at the boxes of other parts."""

MOST_LINES = 100
"""Values along x and along y that are combined."""

TRIED = 24
"""Positions, best for bounding boxes first, at which the exact height is computed."""

SLACK = 1e-6
"""mm by which the top may exceed the build volume through rounding."""


@dataclass(frozen=True, eq=False)
class FreedPacking:
    """A packing without locked groups, as far as its parts may move.

    Attributes
    ----------
    packing
        The packing.
    moved
        Items that were locked and that are elsewhere now, or unplaced.
    """

    packing: Packing
    moved: tuple[int, ...] = ()


def free_locked_items(problem: PackingProblem, packing: Packing, stop: Stop) -> FreedPacking:
    """Return a packing in which no items are locked into each other; fixed items stay.

    Parameters
    ----------
    problem, packing
        The problem, and a packing that keeps its rules.
    stop
        Ends the search for better positions early: the items that are left are placed nowhere, ``out of time``.
    """
    volumes = VolumeBodies(problem)
    fixed = {placement.item for placement in problem.fixed}
    builds = [list(build) for build in packing.builds]
    out = [
        placement
        for number in range(len(builds))
        for placement in _take_out(volumes, builds, number, fixed, stop)
    ]
    if not out:
        return FreedPacking(packing)
    unplaced = list(packing.unplaced)
    for placement in sorted(out, key=lambda each: -volumes.size(each.item)):
        if stop():
            unplaced.append(Unplaced(placement.item, "out of time"))
        elif not _put_in(volumes, builds, placement):
            unplaced.append(Unplaced(placement.item, "no room left"))
    kept = tuple(tuple(sorted(build, key=lambda each: each.item)) for build in builds if build)
    freed = replace(packing, builds=kept, unplaced=tuple(unplaced))
    same = objective_reached(problem, freed) == objective_reached(problem, packing)
    if not same or len(unplaced) > len(packing.unplaced):
        freed = replace(freed, status="feasible")
    return FreedPacking(freed, tuple(sorted(placement.item for placement in out)))


def _take_out(
    volumes: VolumeBodies, builds: list[list[Placement]], number: int, fixed: set[int], stop: Stop
) -> list[Placement]:
    """Take the smallest items of locked groups out of a build until none are locked, and return them."""
    kept = fixed if number == 0 else set()
    out: list[Placement] = []
    while True:
        build = builds[number]
        bodies = [volumes.body(placement) for placement in build]
        locked = find_removal_order(Blocking(bodies, DIRECTIONS), stop, paths=False).locked
        smallest = {
            min(free, key=lambda index: volumes.size(build[index].item))
            for group in locked
            if (free := [index for index in group if build[index].item not in kept])
        }
        if not smallest:
            return out
        out += [build[index] for index in sorted(smallest)]
        builds[number] = [placement for index, placement in enumerate(build) if index not in smallest]


def _put_in(volumes: VolumeBodies, builds: list[list[Placement]], old: Placement) -> bool:
    """Put an item into the first build with a position for it, perhaps a new one; tell whether there is one."""
    problem = volumes.problem
    for build in builds:
        placement = _lowest(volumes, build, old)
        if placement is not None:
            build.append(placement)
            return True
    placement = _lowest(volumes, [], old) if problem.objective == "builds" else None
    if placement is not None:
        builds.append([placement])
    return placement is not None


def _lowest(volumes: VolumeBodies, build: Sequence[Placement], old: Placement) -> Placement | None:
    """Return the lowest placement of an item that is let down into a build; None if it is too high everywhere."""
    problem = volumes.problem
    others = [*(volumes.body(placement) for placement in build), *volumes.zones]
    best: tuple[float, Placement] | None = None
    for rotation in _rotations(problem.items[old.item], old):
        body = volumes.body(Placement(old.item, rotation, np.zeros(3)))
        offsets = _offsets(problem, body, others)
        rest = box_drops(body, others, offsets, problem.lift, problem.clearance)
        top = float(body.high[:, 2].max())
        for index in np.argsort(rest, kind="stable")[:TRIED]:
            z = float(rest[index])
            if z + float(body.low[:, 2].min()) > problem.lift:
                z = min(z, drop(body, others, offsets[index], problem.lift, problem.clearance))
            on_plate = problem.stacking or z + float(body.low[:, 2].min()) <= problem.lift + SLACK
            fits = z + top <= problem.space.size[2] - problem.clearance + SLACK
            if on_plate and fits and (best is None or z + top < best[0] - SLACK):
                best = z + top, Placement(old.item, rotation, np.array([*offsets[index], z]))
    return None if best is None else best[1]


def _rotations(item: Item, old: Placement) -> Floats:
    """Return the rotations that are tried, ``(k, 3, 3)``: all of a list, else the present one."""
    if item.orientations.freedom == "list":
        return np.asarray(item.orientations.matrices)
    return np.asarray(old.rotation[None])


def _offsets(problem: PackingProblem, body: MovableBody, others: Sequence[MovableBody]) -> Floats:
    """Return offsets along x and y at which a body is inside the walls, ``(n, 2)`` mm."""
    size, gap = problem.space.size[:2], problem.clearance
    low, high = body.low.min(axis=0)[:2], body.high.max(axis=0)[:2]
    least, most = gap - low, size - gap - high
    if (most < least - SLACK).any():
        return np.empty((0, 2))
    beside = [other.high.max(axis=0)[:2] + gap - low for other in others]
    beside += [other.low.min(axis=0)[:2] - gap - high for other in others]
    lines = []
    for axis in (0, 1):
        grid = np.linspace(least[axis], most[axis], GRID)
        values = np.clip([*grid, *(each[axis] for each in beside)], least[axis], most[axis])
        found = np.unique(np.round(values, 6))
        lines.append(found[:: len(found) // MOST_LINES + 1])
    offsets = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    if problem.space.shape == "box":
        return offsets
    points = _outline(body)
    reach = [np.hypot(*(points + offset - size / 2).T).max() <= size[0] / 2 - gap for offset in offsets]
    return np.asarray(offsets[np.array(reach, bool)])


def _outline(body: MovableBody) -> Floats:
    """Return the corners ``(n, 2)`` mm of the convex hull of the shadow of a body."""
    placed = zip(body.shapes, body.poses, strict=True)
    return convex_outline(
        np.concatenate([shape.vertices @ pose[:2, :3].T + pose[:2, 3] for shape, pose in placed])
    )
