"""The packer `auto`: a packing at once, a better one as long as there is time, an end when none can be."""

import numpy as np

from amprep.model.control import Report, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packing.auto_builds import pack_builds
from amprep.plugins.packing.bounds import builds_bound, fill_bound
from amprep.plugins.packing.extreme_points import Runner, Solution, as_packing
from amprep.plugins.packing.params import AutoParams
from amprep.plugins.packing.scene import prepare
from amprep.plugins.packing.sortings import Pass, passes

DISTURBANCE = 0.1
"""How far an item moves in a disturbed order, as a share of the number of items."""


def pack_auto(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, report: Report
) -> Packing:
    """Pack by the sortings of `extreme-points`, then search until the bound is met or the budget is used.

    For `builds` the search saves one build after another: the emptiest is dissolved, and a few builds and
    the loose items are packed anew, in a disturbed order, until none is loose (see
    `amprep.kernels.packing_search`). For `fill`, disturbed copies of the best order are packed. The first
    pass is always begun, so that a late stop still gives an answer.
    """
    if problem.objective == "builds":
        return pack_builds(problem, params=params, rng=rng, stop=stop, report=report)
    scene = prepare(problem)
    runner = Runner(scene)
    filling = problem.objective == "fill"
    bound = -fill_bound(scene) if filling else float(builds_bound(scene))
    best, reason = _construct(runner, bound, params, rng, stop)
    return as_packing(scene, best, reason or "finished")


def _construct(
    runner: Runner, bound: float, params: AutoParams, rng: np.random.Generator, stop: Stop
) -> tuple[Solution, str]:
    """Return the best of the passes and why to end with it; for `builds`, half of the work is left.

    `bound` is what the reached number, or less the value, cannot fall below.
    """
    filling = runner.scene.problem.objective == "fill"
    plans = passes(runner.scene)
    best = runner.run(plans[0], None, stop)
    budget = params.work * 1e6 * (1.0 if filling else 0.5)
    number = 1
    while number < len(plans) + (params.patience if filling else 0):
        if best.complete and _met(best, bound, filling=filling):
            return best, "bound met"
        if stop():
            return best, stop.reason
        if runner.work > budget:
            return best, "work used up" if filling else ""
        plan = plans[number] if number < len(plans) else _disturbed(best.plan, plans, rng)
        best = min(best, runner.run(plan, best, stop), key=lambda solution: solution.rank)
        number += 1
    if best.complete and _met(best, bound, filling=filling):
        return best, "bound met"
    return best, "no better one found" if filling else ""


def _met(best: Solution, bound: float, *, filling: bool) -> bool:
    """Whether nothing can be better."""
    reached = best.rank[0] if filling else best.rank[1]
    return (filling or best.rank[0] == 0.0) and reached <= bound + 1e-9 * abs(bound)


def _disturbed(best: Pass, plans: list[Pass], rng: np.random.Generator) -> Pass:
    """Return the best order with each item moved a little at random, under the style of some pass."""
    n = len(best.order)
    order = best.order[np.argsort(np.arange(n) + rng.uniform(0.0, DISTURBANCE * n, n))]
    style = best.style if rng.random() < 0.5 else plans[int(rng.integers(len(plans)))].style
    return Pass(order, style)
