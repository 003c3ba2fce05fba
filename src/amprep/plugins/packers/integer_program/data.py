"""What an integer program places: a body per item, or per item and orientation, and what is in its way."""

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.plugins.packers.instance.prepare import Scene, Variant
from amprep.plugins.packers.params import IpParams


@dataclass(frozen=True, eq=False)
class Body:
    """A copy of an item that may be placed in any of its variants.

    Attributes
    ----------
    variants
        Indices into the variants of the item's kind.
    lo, hi
        ``(v, k, 3)`` mm, the boxes of each variant relative to its least corner.
    least, most
        ``(3,)`` mm, where the least corner of the smallest variant may be.
    """

    item: int
    variants: tuple[int, ...]
    lo: Floats
    hi: Floats
    least: Floats
    most: Floats

    @property
    def size(self) -> Floats:
        """The enclosing box of each variant, ``(v, 3)`` mm."""
        return np.asarray(self.hi.max(axis=1))


class Obstacle(NamedTuple):
    """A box that stands in the first build or, a zone, in all of them."""

    lo: Floats
    hi: Floats
    gap: float
    everywhere: bool


class Piece(NamedTuple):
    """One box of a body, or an obstacle: how far its lower and upper corner may reach, each ``(3,)`` mm.

    Attributes
    ----------
    body
        -1 for an obstacle.
    box
        Of the body, or the obstacle's number.
    """

    body: int
    box: int
    least_lo: Floats
    most_lo: Floats
    least_hi: Floats
    most_hi: Floats


class Pair(NamedTuple):
    """Two pieces that must be `gap` apart along an axis when they are in one build.

    Attributes
    ----------
    possible
        ``(6,)`` whether there is room for each direction: right, left, up, down, front, back.
    """

    one: Piece
    other: Piece
    gap: float
    possible: Bools


@dataclass(frozen=True, eq=False)
class Ground:
    """All that the constraints speak of.

    Attributes
    ----------
    builds
        How many there may be.
    bodies
        In the order of the items: greatest volume first, equal items side by side.
    copies
        The bodies of each item, of which one may be placed, in the same order.
    alike
        Runs of equal items, as indices into `copies`; none without symmetry breaking.
    ordered
        Those of `alike` whose items are one box that cannot be turned: they are in order from left to right.
    reflected
        Whether the first item is kept in the lower half of its build, for every reflection is a packing.
    """

    scene: Scene
    builds: int
    bodies: tuple[Body, ...]
    copies: tuple[tuple[int, ...], ...]
    alike: tuple[tuple[int, ...], ...]
    ordered: tuple[tuple[int, ...], ...]
    reflected: bool
    obstacles: tuple[Obstacle, ...]
    pairs: tuple[Pair, ...]

    @property
    def filling(self) -> bool:
        """Whether items may stay out."""
        return self.scene.problem.objective == "fill"


def count_directions(scene: Scene, params: IpParams) -> int:
    """Return how many direction variables the model would have, without making it."""
    boxes = []
    for item in np.flatnonzero(scene.free).tolist():
        variants = _fitting(scene.kinds[scene.kind[item]])
        boxes.append(len(variants[0][1].lo) * (1 if params.sharing else len(variants)))
    obstacles = len(scene.space.zone_lo) + len(scene.standing_lo)
    total = sum(boxes)
    return 6 * ((total**2 - sum(n**2 for n in boxes)) // 2 + total * obstacles)


def prepare_ground(scene: Scene, builds: int, params: IpParams) -> Ground:
    """Return bodies, obstacles and the pairs among them."""
    items = _in_order(scene)
    bodies: list[Body] = []
    copies: list[tuple[int, ...]] = []
    for item in items:
        found = _bodies(scene, item, params)
        copies.append(tuple(range(len(bodies), len(bodies) + len(found))))
        bodies += found
    alike = _alike(scene, items) if params.symmetry else ()
    ordered = tuple(run for run in alike if _one_box(copies[run[0]], bodies))
    obstacles = _obstacles(scene)
    pairs = _without_left(_pairs(scene, bodies, obstacles, params), bodies, copies, ordered)
    return Ground(
        scene,
        builds,
        tuple(bodies),
        tuple(copies),
        alike,
        ordered,
        params.symmetry and not obstacles and all(body.lo.shape[1] == 1 for body in bodies),
        obstacles,
        tuple(pairs),
    )


def _in_order(scene: Scene) -> list[int]:
    """Return the items to be placed: greatest volume first, equal ones side by side."""

    def key(item: int) -> tuple[float, int, float, int]:
        boxes = scene.kinds[scene.kind[item]][0]
        volume = float((boxes.hi - boxes.lo).prod(axis=1).sum())
        return (-volume, int(scene.kind[item]), -scene.problem.items[item].value, item)

    return sorted(np.flatnonzero(scene.free).tolist(), key=key)


def _alike(scene: Scene, items: list[int]) -> tuple[tuple[int, ...], ...]:
    """Return the runs of items with the same kind and value."""
    runs: list[list[int]] = []
    last: tuple[int, float] | None = None
    for rank, item in enumerate(items):
        sort = (int(scene.kind[item]), scene.problem.items[item].value)
        if sort != last:
            runs.append([])
        runs[-1].append(rank)
        last = sort
    return tuple(tuple(run) for run in runs if len(run) > 1)


def _fitting(kind: tuple[Variant, ...]) -> list[tuple[int, Variant]]:
    """Return the variants that fit an empty build, with their indices."""
    return [(v, variant) for v, variant in enumerate(kind) if np.isfinite(variant.home[0])]


def _bodies(scene: Scene, item: int, params: IpParams) -> list[Body]:
    """Return the item's body, or one for each of its variants."""
    fitting = _fitting(scene.kinds[scene.kind[item]])
    groups = [fitting] if params.sharing else [[pair] for pair in fitting]
    found = []
    for group in groups:
        lo, hi = np.array([v.lo for _, v in group]), np.array([v.hi for _, v in group])
        least, most = scene.space.lo - scene.space.slack, scene.space.hi + scene.space.slack
        most = most - hi.max(axis=1).min(axis=0)
        if scene.space.flat:
            most[2] = scene.space.lo[2] + scene.space.slack
        found.append(Body(item, tuple(v for v, _ in group), lo, hi, least, np.maximum(least, most)))
    return found


def _obstacles(scene: Scene) -> tuple[Obstacle, ...]:
    """Return the zones, which need no clearance, and the boxes of the fixed placements."""
    space, gap = scene.space, scene.problem.clearance
    zones = [
        Obstacle(lo, hi, 0.0, everywhere=True) for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True)
    ]
    standing = zip(scene.standing_lo, scene.standing_hi, strict=True)
    return (*zones, *(Obstacle(lo, hi, gap, everywhere=False) for lo, hi in standing))


def _pairs(scene: Scene, bodies: list[Body], obstacles: tuple[Obstacle, ...], params: IpParams) -> list[Pair]:
    """Return the pairs of boxes of different items, and of boxes and obstacles."""
    pieces = [_pieces(scene, number, body) for number, body in enumerate(bodies)]
    blocks = [Piece(-1, n, o.lo, o.lo, o.hi, o.hi) for n, o in enumerate(obstacles)]
    found: list[tuple[Piece, Piece, float]] = []
    for one, other in combinations(range(len(bodies)), 2):
        if bodies[one].item != bodies[other].item:
            found += [(a, b, scene.problem.clearance) for a in pieces[one] for b in pieces[other]]
    found += [(a, block, obstacles[block.box].gap) for own in pieces for a in own for block in blocks]
    slack = scene.space.slack
    return [Pair(a, b, gap, _possible(a, b, gap - slack, params)) for a, b, gap in found]


def _pieces(scene: Scene, number: int, body: Body) -> list[Piece]:
    """Return the boxes of a body with the reach of their corners."""
    most = scene.space.hi + scene.space.slack - body.size
    if scene.space.flat:
        most[:, 2] = scene.space.lo[2] + scene.space.slack
    lowest, highest = body.least, most[:, None]
    return [
        Piece(
            number,
            box,
            lowest + body.lo[:, box].min(axis=0),
            (highest + body.lo)[:, box].max(axis=0),
            lowest + body.hi[:, box].min(axis=0),
            (highest + body.hi)[:, box].max(axis=0),
        )
        for box in range(body.lo.shape[1])
    ]


def _possible(one: Piece, other: Piece, gap: float, params: IpParams) -> Bools:
    """Return for each direction whether the second piece can be on that side of the first."""
    if not params.tighten:
        return np.ones(6, dtype=bool)
    beyond = one.least_hi + gap <= other.most_lo + 1e-6
    before = other.least_hi + gap <= one.most_lo + 1e-6
    return np.stack((beyond, before), axis=1).ravel()


def _one_box(copies: tuple[int, ...], bodies: list[Body]) -> bool:
    """Return whether an item is one box that cannot be turned."""
    return len(copies) == 1 and bodies[copies[0]].lo.shape[:2] == (1, 1)


def _without_left(
    pairs: list[Pair],
    bodies: list[Body],
    copies: list[tuple[int, ...]],
    ordered: tuple[tuple[int, ...], ...],
) -> list[Pair]:
    """Return the pairs without the direction left among equal items in order from left to right."""
    run_of = {copies[rank][0]: number for number, run in enumerate(ordered) for rank in run}
    # a box as thin as what contact may give can be on both sides at once
    thick = {number for number in run_of if float(bodies[number].hi[0, 0, 0]) > 0.01}
    left = np.array([True, False, True, True, True, True])

    def kept(pair: Pair) -> Pair:
        one, other = pair.one.body, pair.other.body
        if one in thick and other in thick and run_of[one] == run_of[other]:
            return pair._replace(possible=pair.possible & left)
        return pair

    return [kept(pair) for pair in pairs]
