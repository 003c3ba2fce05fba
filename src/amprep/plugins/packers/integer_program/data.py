"""The data of the integer program: copies of items to be placed, obstacles, and pairs of boxes."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.model.control import Stop
from amprep.plugins.packers.instance.prepare import ItemType, PreparedInstance
from amprep.plugins.packers.params import IpParams


@dataclass(frozen=True, eq=False)
class ItemCopy:
    """A copy of an item that may be placed in any of its orientations; copies of one item exclude each other.

    Attributes
    ----------
    orientations
        Numbers of the orientations in the instance.
    lo, hi
        ``(o, k, 3)`` mm, the boxes of each orientation relative to its least corner.
    least, most
        ``(3,)`` mm, range of the least corner of the smallest orientation.
    """

    item: int
    orientations: tuple[int, ...]
    lo: Floats
    hi: Floats
    least: Floats
    most: Floats

    @property
    def size(self) -> Floats:
        """The enclosing box of each orientation, ``(o, 3)`` mm."""
        return np.asarray(self.hi.max(axis=1))


class Obstacle(NamedTuple):
    """A fixed box, which is in the first build, or a forbidden zone, which is in every build."""

    lo: Floats
    hi: Floats
    gap: float
    everywhere: bool


class ModelBox(NamedTuple):
    """One box of a copy, or an obstacle, with the ranges of its lower and upper corner, each ``(3,)`` mm.

    Attributes
    ----------
    copy
        Number of the copy; -1 for an obstacle.
    number
        Number of the box within the copy, or number of the obstacle.
    """

    copy: int
    number: int
    least_lo: Floats
    most_lo: Floats
    least_hi: Floats
    most_hi: Floats


class Pair(NamedTuple):
    """Two boxes that must be apart along an axis when they are in one build.

    Attributes
    ----------
    gap
        Distance that the packing keeps along that axis, mm.
    required
        ``(3,)`` mm, distance along each axis that the program demands.
    possible
        ``(6,)`` whether there is room for each direction: right, left, up, down, front, back.
    """

    one: ModelBox
    other: ModelBox
    gap: float
    required: Floats
    possible: Bools


@dataclass(frozen=True, eq=False)
class ModelData:
    """The data that variables and constraints refer to.

    Attributes
    ----------
    builds
        Greatest number of builds.
    copies
        Copies of the items: the item of greatest volume first, equal items after one another.
    copies_of
        Numbers of the copies of each item, in the same order; at most one of them is placed.
    alike
        Runs of equal items, as indices into `copies_of`; empty without symmetry breaking.
    ordered
        Those of `alike` whose items are single boxes that cannot be turned: they are ordered from left to right.
    reflected
        Whether the first item is kept in the lower half of its build, because every reflection is a packing.
    relaxed
        Whether boxes may be closer along an axis than the clearance, because they may be apart at corners as well.
    """

    instance: PreparedInstance
    builds: int
    copies: tuple[ItemCopy, ...]
    copies_of: tuple[tuple[int, ...], ...]
    alike: tuple[tuple[int, ...], ...]
    ordered: tuple[tuple[int, ...], ...]
    reflected: bool
    obstacles: tuple[Obstacle, ...]
    pairs: tuple[Pair, ...]
    relaxed: bool

    @property
    def proves(self) -> bool:
        """Whether the program admits every packing that the judge accepts, so that its bounds hold."""
        return self.relaxed or not keeps_corners_apart(self.instance)

    @property
    def filling(self) -> bool:
        """Whether items may be left out."""
        return self.instance.filling

    @property
    def value_unit(self) -> float:
        """Greatest value of an item, the unit of the objective, so that tolerances mean the same in every problem."""
        values = (self.instance.problem.items[copy.item].value for copy in self.copies)
        return max(values, default=1.0) or 1.0


def count_directions(instance: PreparedInstance, params: IpParams) -> int:
    """Return the number of direction variables of the model, without building it."""
    boxes = []
    for item in np.flatnonzero(instance.free).tolist():
        item_type = instance.types[instance.type_of[item]]
        fitting = sum(orientation.fits for orientation in item_type)
        boxes.append(len(item_type[0].lo) * (1 if params.sharing else fitting))
    obstacles = len(instance.space.zone_lo) + len(instance.fixed_lo)
    total = sum(boxes)
    return 6 * ((total**2 - sum(n**2 for n in boxes)) // 2 + total * obstacles)


def keeps_corners_apart(instance: PreparedInstance) -> bool:
    """Return whether a distance at corners is demanded: a clearance above the tolerance."""
    return instance.problem.clearance > instance.space.slack


def prepare_model_data(
    instance: PreparedInstance, builds: int, params: IpParams, stop: Stop, *, relaxed: bool = False
) -> ModelData:
    """Return the copies of the items, the obstacles, and the pairs of their boxes.

    When told to stop, the result is incomplete, as that of `make_program` is. A stop stays true, so `solve` does not
    run it.

    Parameters
    ----------
    builds
        Greatest number of builds.
    relaxed
        Whether the program admits every packing that the judge accepts, also those whose boxes keep the clearance at
        corners only.
    """
    items = _in_order(instance)
    copies: list[ItemCopy] = []
    copies_of: list[tuple[int, ...]] = []
    for item in items:
        found = _copies(instance, item, params)
        copies_of.append(tuple(range(len(copies), len(copies) + len(found))))
        copies += found
    alike = _alike(instance, items) if params.symmetry else ()
    ordered = tuple(run for run in alike if _is_one_box(copies_of[run[0]], copies))
    obstacles = _obstacles(instance)
    pairs = _pairs(instance, copies, obstacles, params, stop, relaxed=relaxed)
    return ModelData(
        instance,
        builds,
        tuple(copies),
        tuple(copies_of),
        alike,
        ordered,
        params.symmetry and not obstacles and all(copy.lo.shape[1] == 1 for copy in copies),
        obstacles,
        tuple(_without_left(pairs, copies, copies_of, ordered)),
        relaxed,
    )


def _in_order(instance: PreparedInstance) -> list[int]:
    """Return the items to be placed: the greatest volume first, equal items after one another."""

    def key(item: int) -> tuple[float, int, float, int]:
        boxes = instance.types[instance.type_of[item]][0]
        volume = float((boxes.hi - boxes.lo).prod(axis=1).sum())
        return (-volume, int(instance.type_of[item]), -instance.problem.items[item].value, item)

    return sorted(np.flatnonzero(instance.free).tolist(), key=key)


def _alike(instance: PreparedInstance, items: list[int]) -> tuple[tuple[int, ...], ...]:
    """Return the runs of items with the same type and value."""
    runs: list[list[int]] = []
    last: tuple[int, float] | None = None
    for rank, item in enumerate(items):
        sort = (int(instance.type_of[item]), instance.problem.items[item].value)
        if sort != last:
            runs.append([])
        runs[-1].append(rank)
        last = sort
    return tuple(tuple(run) for run in runs if len(run) > 1)


def _copies(instance: PreparedInstance, item: int, params: IpParams) -> list[ItemCopy]:
    """Return one copy of the item for all its orientations that fit, or one for each of them."""
    first = instance.first_orientation[instance.type_of[item] :]
    fitting = [number for number in range(first[0], first[1]) if instance.orientations[number].fits]
    groups = [fitting] if params.sharing else [[number] for number in fitting]
    found = []
    for group in groups:
        turned: ItemType = tuple(instance.orientations[number] for number in group)
        lo, hi = np.array([each.lo for each in turned]), np.array([each.hi for each in turned])
        least, most = instance.space.lo - instance.space.slack, instance.space.hi + instance.space.slack
        most = most - hi.max(axis=1).min(axis=0)
        if instance.space.flat:
            most[2] = instance.space.lo[2] + instance.space.slack
        found.append(ItemCopy(item, tuple(group), lo, hi, least, np.maximum(least, most)))
    return found


def _obstacles(instance: PreparedInstance) -> tuple[Obstacle, ...]:
    """Return the forbidden zones, which need no clearance, and the fixed boxes."""
    space, gap = instance.space, instance.problem.clearance
    zones = [
        Obstacle(lo, hi, 0.0, everywhere=True) for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True)
    ]
    fixed = zip(instance.fixed_lo, instance.fixed_hi, strict=True)
    return (*zones, *(Obstacle(lo, hi, gap, everywhere=False) for lo, hi in fixed))


def _pairs(
    instance: PreparedInstance,
    copies: list[ItemCopy],
    obstacles: tuple[Obstacle, ...],
    params: IpParams,
    stop: Stop,
    *,
    relaxed: bool,
) -> list[Pair]:
    """Return the pairs of boxes of different items, and of boxes and obstacles, as far as `stop` allows."""
    boxes = [_boxes(instance, number, copy) for number, copy in enumerate(copies)]
    blocks = [ModelBox(-1, n, o.lo, o.lo, o.hi, o.hi) for n, o in enumerate(obstacles)]
    found: list[Pair] = []
    for one, other, gap in _box_pairs(instance, copies, obstacles, boxes, blocks):
        if stop():
            break
        distance = _required(one, other, gap, instance.space.slack, relaxed=relaxed)
        found.append(Pair(one, other, gap, distance, _possible(one, other, distance, params)))
    return found


def _box_pairs(
    instance: PreparedInstance,
    copies: list[ItemCopy],
    obstacles: tuple[Obstacle, ...],
    boxes: list[list[ModelBox]],
    blocks: list[ModelBox],
) -> Iterator[tuple[ModelBox, ModelBox, float]]:
    """Yield the pairs with the distance that they keep, mm."""
    for one, other in combinations(range(len(copies)), 2):
        if copies[one].item != copies[other].item:
            for pair in product(boxes[one], boxes[other]):
                yield (*pair, instance.problem.clearance)
    for own in boxes:
        for box, block in product(own, blocks):
            yield box, block, obstacles[block.number].gap


def _required(one: ModelBox, other: ModelBox, gap: float, slack: float, *, relaxed: bool) -> Floats:
    """Return the least distance of two boxes along the axis on which they are farthest apart, ``(3,)`` mm.

    Strategy: without relaxation it is `gap` along every axis. The judge measures distances in space, so boxes that
    keep `gap` may be closer than it along every axis. Let the axis be x, and let there be room for distances of at
    most b and c along y and z. Then x^2 + min(x, b)^2 + min(x, c)^2 is at least gap^2. With b at most c, the least x
    is gap / sqrt(3) if that is at most b, else the root for y fixed at b if that is at most c, else the root with
    both fixed.
    """
    distance = gap - slack
    if not relaxed or distance <= 0.0:
        return np.full(3, distance)
    room = np.maximum(np.maximum(other.most_lo - one.least_hi, one.most_lo - other.least_hi), 0.0)
    found = np.empty(3)
    for axis in range(3):
        b, c = sorted(np.delete(room, axis).tolist())
        least = distance / math.sqrt(3.0)
        if least > b:
            least = math.sqrt(max(distance**2 - b**2, 0.0) / 2.0)
            if least > c:
                least = math.sqrt(max(distance**2 - b**2 - c**2, 0.0))
        found[axis] = least
    return found


def _boxes(instance: PreparedInstance, number: int, copy: ItemCopy) -> list[ModelBox]:
    """Return the boxes of a copy with the ranges of their corners."""
    most = instance.space.hi + instance.space.slack - copy.size
    if instance.space.flat:
        most[:, 2] = instance.space.lo[2] + instance.space.slack
    lowest, highest = copy.least, most[:, None]
    return [
        ModelBox(
            number,
            k,
            lowest + copy.lo[:, k].min(axis=0),
            (highest + copy.lo)[:, k].max(axis=0),
            lowest + copy.hi[:, k].min(axis=0),
            (highest + copy.hi)[:, k].max(axis=0),
        )
        for k in range(copy.lo.shape[1])
    ]


def _possible(one: ModelBox, other: ModelBox, required: Floats, params: IpParams) -> Bools:
    """Return for each direction whether the second box can be on that side of the first."""
    if not params.tighten:
        return np.ones(6, dtype=bool)
    beyond = one.least_hi + required <= other.most_lo + 1e-6
    before = other.least_hi + required <= one.most_lo + 1e-6
    return np.stack((beyond, before), axis=1).ravel()


def _is_one_box(own: tuple[int, ...], copies: list[ItemCopy]) -> bool:
    """Return whether an item is a single box that cannot be turned."""
    return len(own) == 1 and copies[own[0]].lo.shape[:2] == (1, 1)


def _without_left(
    pairs: list[Pair],
    copies: list[ItemCopy],
    copies_of: list[tuple[int, ...]],
    ordered: tuple[tuple[int, ...], ...],
) -> list[Pair]:
    """Return the pairs without the direction left among equal items that are ordered from left to right."""
    run_of = {copies_of[rank][0]: number for number, run in enumerate(ordered) for rank in run}
    # a box as thin as the contact tolerance can be on both sides at once
    thick = {number for number in run_of if float(copies[number].hi[0, 0, 0]) > 0.01}
    left = np.array([True, False, True, True, True, True])

    def kept(pair: Pair) -> Pair:
        one, other = pair.one.copy, pair.other.copy
        if one in thick and other in thick and run_of[one] == run_of[other]:
            return pair._replace(possible=pair.possible & left)
        return pair

    return [kept(pair) for pair in pairs]
