"""The packer `extreme-points`: the best of many constructive passes, each packed by the compiled kernel."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.extreme_points import PAUSED, pack
from amprep.kernels.boxes.positions import LEFT, WORK, PassState
from amprep.kernels.boxes.records import CENTRE, LOW, MERIT_OF, RESIDUAL, TOUCHING, Arrangement
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.combinatorial import packing_bound
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing, value_of
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.params import ExtremePointsParams
from amprep.plugins.packers.sweep import with_rows

PAUSE = 10_000_000
"""Comparisons between two calls of `stop`, some 20 ms."""

GRID = 1024
"""Greatest number of line crossings that are tried besides the extreme points."""

BANDS = (0.1, 0.2, 0.3, 0.5)
"""Widths of the clusters, as fractions of the area or height of the build volume."""

EARLY = (
    (0, 1), (2, 0), (24, 2), (21, 0), (0, 2), (3, 0), (5, 1), (9, 0), (10, 0), (12, 0), (14, 2), (28, 0),
)  # fmt: skip
"""Passes (number of the ordering, number of the rule) that, one after another, saved most builds over classes 1 to 8
of Martello, Pisinger and Vigo with 50, 100 and 200 boxes; the other 75 passes saved no further builds there."""

ENOUGH, ALL = 12, 1000
"""Numbers of passes that `enough_passes` returns."""

MANY = 500
"""Number of items above which passes by contact area come last: they take some twenty times as long as others."""


class ConstructivePass(NamedTuple):
    """An ordering of the items, and the placement rule ``(6,)`` that chooses among candidate positions."""

    order: Int64s
    rule: Floats


class PassResult(NamedTuple):
    """Result of a constructive pass.

    Attributes
    ----------
    rank
        Smaller for a better arrangement: builds (or value), then total height, then covered area.
    complete
        False when the pass was stopped before its end.
    """

    arrangement: Arrangement
    rank: tuple[float, ...]
    complete: bool
    source: ConstructivePass


def pack_extreme_points(
    problem: PackingProblem,
    *,
    params: ExtremePointsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack by extreme points (Crainic, Perboli, Tadei 2008, doi:10.1287/ijoc.1070.0250)."""
    instance = prepare(problem)
    if problem.objective == "height":
        from amprep.plugins.packers.lowest_build import lowest_by_orderings

        return as_packing(
            instance, lowest_by_orderings(instance, params=params, rng=rng, stop=stop, progress=progress)
        )
    return as_packing(instance, construct(instance, params=params, rng=rng, stop=stop, progress=progress))


def construct(
    instance: PreparedInstance,
    *,
    params: ExtremePointsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the best of many constructive passes over extreme points.

    The items are packed in every ordering under every placement rule, then in disturbed copies of the best ordering.
    The best arrangement has the fewest builds, then the least total height, then the least covered area; in a fill
    problem the greatest value. The first pass is always begun, so that a late stop still gives a result.
    """
    runner = PassRunner(instance)
    passes = constructive_passes(instance)[: params.orderings or enough_passes(instance)]
    count = len(passes) + params.restarts
    best, reason = runner.run(passes[0], None, stop), ""
    for number in range(1, count):
        if stop():
            reason = stop.reason
            break
        if runner.work > params.work * 1e6:
            reason = "work used up"
            break
        progress(number / count, "trying orderings")
        tried = passes[number] if number < len(passes) else disturbed(best.source, params.disturbance, rng)
        best = min(best, runner.run(tried, best, stop), key=lambda result: result.rank)
    reason = reason or (stop.reason if stop() else "finished")
    return PackerResult(best.arrangement, packing_bound(instance), reason, best.complete)


def disturbed(source: ConstructivePass, disturbance: float, rng: np.random.Generator) -> ConstructivePass:
    """Return the pass with each item moved at random by up to `disturbance` of the length of the ordering."""
    n = len(source.order)
    ranks = np.arange(n) + rng.uniform(0.0, disturbance * n, n)
    return source._replace(order=source.order[np.argsort(ranks)])


class PassRunner:
    """Runs constructive passes over one instance, and owns the work arrays of the kernel.

    Attributes
    ----------
    work
        Comparisons made so far.
    """

    def __init__(self, instance: PreparedInstance) -> None:
        self.instance = instance
        self.work = 0
        self.state = _pass_state(instance)

    def run(self, tried: ConstructivePass, best: PassResult | None, stop: Stop) -> PassResult:
        """Run a pass; it gives up once it needs more builds than `best`, and ends when told to stop.

        Without a `best`, the items that have no position yet are packed into rows where that is possible.
        """
        n, boxes = len(self.instance.type_of), self.instance.boxes
        most = 1 if self.instance.in_one_build else n if best is None else int(best.rank[1])
        arrangement, state = Arrangement.unassigned(n), self.state
        state.cursor[:] = 0
        state.cursor[LEFT] = len(tried.order)
        state.failed[:] = -1
        state.extents[:] = 0.0
        code = PAUSED
        while code == PAUSED and len(tried.order):
            code = pack(tried.order, boxes, len(boxes.obstacles), tried.rule, most, PAUSE, arrangement, state)
            self.work += int(state.cursor[WORK])
            if stop():
                break
        complete = code != PAUSED or not len(tried.order)
        rows = with_rows(self.instance, arrangement) if not complete and best is None else None
        if rows is not None:
            return PassResult(rows, (0.0, float(rows.builds), np.inf, np.inf), True, tried)
        return PassResult(arrangement, self._rank(arrangement), complete, tried)

    def _rank(self, arrangement: Arrangement) -> tuple[float, ...]:
        """Return the rank of an arrangement that the kernel has just made."""
        height, area = self.state.extents.sum(axis=0).tolist()
        if self.instance.filling:
            return (-value_of(self.instance, arrangement), height, area)
        left = float(self.state.cursor[LEFT])
        return (
            (left, height, area)
            if self.instance.in_one_build
            else (left, float(arrangement.builds), height, area)
        )


def _pass_state(instance: PreparedInstance) -> PassState:
    """Return work arrays for the fullest build there can be."""
    most = np.array([max(len(o.lo) for o in item_type) for item_type in instance.types], dtype=np.int64)
    boxes = len(instance.boxes.obstacles) + int(most[instance.type_of[instance.free]].sum())
    points = 6 * boxes + 2
    return PassState(
        placed=np.zeros((boxes + 1, 6)),
        points=np.zeros((points, 7)),
        lines=np.zeros((2, 2 * boxes + 1)),
        candidates=np.zeros((int(most.max(initial=1)) * (points + 4 * GRID) + 16 * boxes + 1000, 5)),
        failed=np.full(len(instance.types), -1, np.int64),
        cursor=np.zeros(9, np.int64),
        best=np.zeros(5),
        extents=np.zeros((len(instance.type_of) + 1, 2)),
    )


def constructive_passes(instance: PreparedInstance) -> list[ConstructivePass]:
    """Return every ordering under every placement rule, the most successful ones first."""
    rules, orderings = list(placement_rules(instance)), list(_orderings(instance))
    every = [(order, rule) for order in range(len(orderings)) for rule in range(len(rules))]
    if _is_stacked(instance):
        early = [pair for pair in EARLY if pair in every]
        every = early + [pair for pair in every if pair not in early]
        if np.count_nonzero(instance.free) > MANY:
            every.sort(key=lambda pair: rules[pair[1]][MERIT_OF] == TOUCHING)
    return [ConstructivePass(orderings[order], rules[rule]) for order, rule in every]


def enough_passes(instance: PreparedInstance) -> int:
    """Return the number of passes that are useful where time is short."""
    return ENOUGH if _is_stacked(instance) and instance.problem.objective == "builds" else ALL


def _is_stacked(instance: PreparedInstance) -> bool:
    """Return whether items are stacked in a box-shaped build volume, the case for which `EARLY` was found."""
    return not (instance.space.radius or instance.space.flat)


def placement_rules(instance: PreparedInstance) -> Iterator[Floats]:
    """Yield the placement rules that suit the room."""
    x, y, z = np.maximum(instance.space.hi - instance.space.lo, 1e-9).tolist()
    rows = [1.0 / x, 1e3 / y, 1e6 / z]
    columns = [1e3 / x, 1.0 / y, 1e6 / z]
    if instance.space.radius:
        for phase in range(4):
            yield _rule(CENTRE, [0.0, 0.0, 1e3 * x], GRID, phase)
            yield _rule(LOW, rows, 0, phase)
            yield _rule(LOW, columns, 0, phase)
            yield _rule(TOUCHING, rows, GRID, phase)
    elif instance.space.flat:
        yield _rule(LOW, rows, GRID)
        yield _rule(LOW, columns, GRID)
        yield _rule(TOUCHING, rows, GRID)
        yield _rule(RESIDUAL, rows)
    else:
        yield _rule(RESIDUAL, rows)
        yield _rule(TOUCHING, rows)
        yield _rule(LOW, rows)


def _rule(merit: int, weights: list[float], grid: int = 0, phase: int = 0) -> Floats:
    """Return a placement rule as the kernel reads it."""
    return np.array([merit, *weights, grid, phase], dtype=np.float64)


def _orderings(instance: PreparedInstance) -> Iterator[Int64s]:
    """Yield the orderings of the free items, each once."""
    free = np.flatnonzero(instance.free)
    seen: set[bytes] = set()
    for keys in _keys(instance, free):
        # equal keys keep the copies of a part together, which gives rows of equal parts
        columns = np.array(
            [free, instance.type_of[free], *(-key for key in reversed(keys))], dtype=np.float64
        )
        order = free[np.lexsort(columns)]
        if order.tobytes() not in seen:
            seen.add(order.tobytes())
            yield order


def _keys(instance: PreparedInstance, free: Int64s) -> Iterator[tuple[Floats, ...]]:
    """Yield tuples of sort keys, greatest first; the first key of a tuple is the most important."""
    size = np.array([item_type[0].size for item_type in instance.types]).reshape(-1, 3)[
        instance.type_of[free]
    ]
    room = np.maximum(instance.space.hi - instance.space.lo, 1e-9)
    volume, area = size.prod(axis=1), size[:, 0] * size[:, 1]
    measure = area if instance.space.flat else volume
    if instance.filling:
        value = np.array([instance.problem.items[i].value for i in free.tolist()])
        yield (value / np.maximum(measure, 1e-12), value)
        yield (value, -measure)
        yield (value / np.maximum(np.sqrt(measure), 1e-12), value)
    yield (measure,)
    yield (size.max(axis=1), measure)
    yield (size[:, :2].max(axis=1) if instance.space.flat else size.min(axis=1), measure)
    yield (size.sum(axis=1), measure)
    yield (size[:, 2], area)
    yield from _clustered(size, room, (0, 1) if instance.space.flat else (2, 1, 0), flat=instance.space.flat)


def _clustered(
    size: Floats, room: Floats, axes: tuple[int, ...], *, flat: bool
) -> Iterator[tuple[Floats, ...]]:
    """Yield the keys of the clustered area-height and height-area orderings along each axis, for each band."""
    for band in BANDS:
        for axis in axes:
            across = [a for a in ((0, 1) if flat else (0, 1, 2)) if a != axis]
            area, height = size[:, across].prod(axis=1), size[:, axis]
            yield (np.ceil(area / (room[across].prod() * band) - 1e-9), height, area)
            yield (np.ceil(height / (room[axis] * band) - 1e-9), area, height)
