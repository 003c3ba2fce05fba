"""The part of `auto` for fewest builds: sortings, then a search, while a second thread proves a bound."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.auto.ruin_and_recreate import Search
from amprep.plugins.packers.bounds.fractional_cover import CoverBound
from amprep.plugins.packers.bounds.volume import builds_bound
from amprep.plugins.packers.extreme_points import Runner
from amprep.plugins.packers.instance.orders import passes
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing
from amprep.plugins.packers.params import AutoParams


def pack_builds(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack by the sortings of `extreme-points`, then search until the bound is met or the budget is used.

    The search saves one build after another: the emptiest is dissolved, and a few builds and the loose items
    are packed anew, in a disturbed order, until none is loose (see `amprep.kernels.boxes.ruin_and_recreate`); from time
    to time builds are chosen among all that were met (`choose_builds`). Meanwhile `CoverBound` raises the
    bound. Both budgets are used in full unless the two meet, so the answer does not depend on the clock. The
    first pass is always begun, so that a late stop still gives an answer.
    """
    scene = prepare(problem)
    runner = Runner(scene)
    bound = builds_bound(scene)
    best, reason = _construct(runner, bound, params, stop)
    if reason or not best.complete or best.rank[0]:
        return as_packing(scene, best, reason or "finished", proved=bound)
    search = Search(runner, best, params, rng)
    with _proof(CoverBound(scene, bound), search, params, stop) as proof:
        while not reason:
            share = min(float(search.spent[0]) / (params.work * 1e6 + 1.0), 1.0)
            progress(share, f"{search.builds} builds, bound {proof.builds}")
            reason = search.save_a_build(lambda: proof.builds, stop)
    # the proof may go on when the search is through; which ends first must not show
    reason = "bound met" if search.builds <= proof.builds else reason
    return as_packing(scene, search.best, reason, proved=proof.builds)


@contextmanager
def _proof(proof: CoverBound, search: Search, params: AutoParams, stop: Stop) -> Iterator[CoverBound]:
    """Prove a bound in a thread of its own; leave when it is done, or at once when told to stop."""
    work = params.proof * 1e6
    thread = Thread(target=proof.prove, args=(lambda: search.builds, work, stop), name="bound", daemon=True)
    thread.start()
    try:
        yield proof
        while thread.is_alive() and not stop():
            thread.join(0.02)
    finally:
        proof.halt()
        thread.join()


def _construct(runner: Runner, bound: int, params: AutoParams, stop: Stop) -> tuple[Solution, str]:
    """Return the best of the passes and why to end with it, if so; half of the work is left for the search."""
    plans = passes(runner.scene)
    best = runner.run(plans[0], None, stop)
    for plan in plans[1:]:
        if best.complete and best.rank[0] == 0.0 and best.rank[1] <= bound:
            return best, "bound met"
        if stop():
            return best, stop.reason
        if runner.work > params.work * 0.5e6:
            return best, ""
        best = min(best, runner.run(plan, best, stop), key=lambda solution: solution.rank)
    return best, "bound met" if best.complete and best.rank[0] == 0.0 and best.rank[1] <= bound else ""
