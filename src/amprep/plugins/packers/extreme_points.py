"""The packer `extreme-points`: the best of many sortings, each packed by the compiled kernel."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes import places as records
from amprep.kernels.boxes.extreme_points import pack
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.instance.orders import GRID, Pass, enough_passes, passes
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing, value_of
from amprep.plugins.packers.params import ExtremePointsParams
from amprep.plugins.packers.sweep import with_rows

PAUSE = 10_000_000
"""Comparisons between two looks at `stop`, some 20 ms."""


def pack_extreme_points(
    problem: PackingProblem,
    *,
    params: ExtremePointsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack by extreme points (Crainic, Perboli, Tadei 2008, doi:10.1287/ijoc.1070.0250).

    Items are packed in the order of each sorting under each style, then in disturbed copies of the best
    order, and the best packing is kept: fewest builds, then least total height, then least area covered; or
    greatest value. The first pass is always begun, so that a late stop still gives an answer.
    """
    scene = prepare(problem)
    runner = Runner(scene)
    plans = passes(scene)[: params.sortings or enough_passes(scene)]
    best = runner.run(plans[0], None, stop)
    for number in range(1, len(plans) + params.restarts):
        if stop():
            return as_packing(scene, best, stop.reason)
        if runner.work > params.work * 1e6:
            return as_packing(scene, best, "work used up")
        progress(number / (len(plans) + params.restarts), "trying orders")
        plan = plans[number] if number < len(plans) else _disturbed(best.plan, params.disturbance, rng)
        best = min(best, runner.run(plan, best, stop), key=lambda solution: solution.rank)
    return as_packing(scene, best, stop.reason if stop() else "finished")


def _disturbed(plan: Pass, disturbance: float, rng: np.random.Generator) -> Pass:
    """Return the plan with each item moved at random by up to `disturbance` of the list."""
    n = len(plan.order)
    return plan._replace(order=plan.order[np.argsort(np.arange(n) + rng.uniform(0.0, disturbance * n, n))])


class Runner:
    """Runs passes over one scene; owns the kernel's arrays."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.work = 0
        self.shapes = _shapes(scene)
        self.room = _room(scene)
        self.obstacles, self.zones = _obstacles(scene), len(scene.space.zone_lo)
        self.scratch = _scratch(scene)

    def run(self, plan: Pass, best: Solution | None, stop: Stop) -> Solution:
        """Run a pass; it gives up once it needs more builds than `best`, and ends when told to stop.

        Without a `best` what then has no place yet is put into rows, if it can be.
        """
        n = len(self.scene.kind)
        most = 1 if self.scene.problem.objective == "fill" else n if best is None else int(best.rank[1])
        answer = records.Answer(
            np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros((n, 3)), np.zeros((n + 1, 2))
        )
        self.scratch.cursor[:] = 0
        self.scratch.cursor[records.LEFT] = len(plan.order)
        self.scratch.failed[:] = -1
        code = records.PAUSED
        while code == records.PAUSED and len(plan.order):
            code = pack(
                plan.order,
                self.shapes,
                self.room,
                self.obstacles,
                self.zones,
                plan.style,
                most,
                PAUSE,
                answer,
                self.scratch,
            )
            self.work += int(self.scratch.cursor[records.WORK])
            if stop():
                break
        complete = code != records.PAUSED or not len(plan.order)
        variant = answer.variant - self.shapes.first_variant[self.scene.kind]
        found = Solution(plan, self._rank(answer), complete, answer.build, variant, answer.place)
        return found if complete or best is not None else with_rows(self.scene, found)

    def _rank(self, answer: records.Answer) -> tuple[float, ...]:
        """Return what is smaller for a better answer."""
        looks = answer.looks.sum(axis=0).tolist()
        if self.scene.problem.objective == "fill":
            return (-value_of(self.scene, answer.build), *looks)
        return (float(self.scratch.cursor[records.LEFT]), float(answer.build.max(initial=-1) + 1), *looks)


def _shapes(scene: Scene) -> records.Shapes:
    """Return the scene's kinds as the kernel's arrays, clearance added at the upper sides."""
    gap = scene.problem.clearance
    variants = [variant for kind in scene.kinds for variant in kind]
    return records.Shapes(
        kind=scene.kind,
        first_variant=_starts([len(kind) for kind in scene.kinds]),
        first_box=_starts([len(variant.lo) for variant in variants]),
        variants=np.array([[*(variant.size + gap), *variant.home] for variant in variants]).reshape(-1, 6),
        boxes=np.array(
            [[*lo, *(hi + gap)] for v in variants for lo, hi in zip(v.lo, v.hi, strict=True)]
        ).reshape(-1, 6),
    )


def _starts(lengths: list[int]) -> Int64s:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)


def _room(scene: Scene) -> Floats:
    """Return the kernel's room: items are longer by the clearance, so the upper walls are further by it."""
    space, gap = scene.space, scene.problem.clearance
    corners, rules = (*space.lo, *(space.hi + gap)), (gap, space.slack, float(space.flat))
    return np.array([*corners, *space.axis, space.radius, *rules, *_least_space(scene)])


def _least_space(scene: Scene) -> Floats:
    """Return the residual space that a point needs to be of use, ``(3,)`` mm; for items of several boxes any."""
    variants = [variant for kind in scene.kinds for variant in kind]
    if not variants or any(len(variant.lo) > 1 for variant in variants):
        return np.full(3, records.PAIR_SLACK)
    least = np.min([variant.size for variant in variants], axis=0)
    return np.asarray(np.maximum(least + scene.problem.clearance - scene.space.slack, records.PAIR_SLACK))


def _obstacles(scene: Scene) -> Floats:
    """Return zones and fixed boxes ``(m, 6)``.

    Zones need no clearance: their lower sides are moved up by it, which cancels that of the items.
    """
    gap = scene.problem.clearance
    zones = np.hstack((scene.space.zone_lo + gap, scene.space.zone_hi))
    return np.concatenate((zones, np.hstack((scene.standing_lo, scene.standing_hi + gap))))


def _scratch(scene: Scene) -> records.Scratch:
    """Return work arrays for the fullest build there can be."""
    most = np.array([max(len(variant.lo) for variant in kind) for kind in scene.kinds], dtype=np.int64)
    boxes = len(scene.space.zone_lo) + len(scene.standing_lo) + int(most[scene.kind[scene.free]].sum())
    return records.Scratch(
        placed=np.zeros((boxes + 1, 6)),
        points=np.zeros((6 * boxes + 2, 7)),
        lines=np.zeros((2, 2 * boxes + 1)),
        candidates=np.zeros((int(most.max(initial=1)) * (6 * boxes + 2 + 4 * GRID) + 16 * boxes + 1000, 5)),
        failed=np.full(len(scene.kinds), -1, np.int64),
        cursor=np.zeros(9, np.int64),
        best=np.zeros(5),
    )
