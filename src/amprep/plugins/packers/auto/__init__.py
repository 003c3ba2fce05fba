"""The packer `auto`: boxes at once, then better packings until the bound is met or the budget is used up.

Where the volumes are not made of boxes, the packing of enclosing boxes is improved with the true shapes.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

import numpy as np

from amprep.model.bounding_volume import Boxes
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.auto.fill import fill_build
from amprep.plugins.packers.auto.height import lower_build
from amprep.plugins.packers.auto.lists import in_lists
from amprep.plugins.packers.auto.ruin_and_recreate import RuinAndRecreate
from amprep.plugins.packers.bounds.combinatorial import builds_bound
from amprep.plugins.packers.bounds.fractional_cover import CoveringBound
from amprep.plugins.packers.extreme_points import PassResult, PassRunner, constructive_passes
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.params import AutoParams


def pack_auto(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack by the passes of `extreme-points`, then search until the bound is met or the budget is used up.

    The first pass is always begun, so that a late stop still gives a result.
    """
    if all(isinstance(item.volume, Boxes) for item in problem.items):
        instance = prepare(in_lists(problem))
        return as_packing(
            instance, pack_boxes(instance, params=params, rng=rng, stop=stop, progress=progress)
        )
    from amprep.plugins.packers.auto.true_shapes import pack_true_shapes

    return pack_true_shapes(problem, pack_boxes, params=params, rng=rng, stop=stop, progress=progress)


def pack_boxes(
    instance: PreparedInstance,
    *,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Pack boxes for any objective."""
    pack = {"fill": fill_build, "height": lower_build, "builds": pack_builds}[instance.problem.objective]
    return pack(instance, params=params, rng=rng, stop=stop, progress=progress)


def pack_builds(
    instance: PreparedInstance,
    *,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Pack into few builds: passes of extreme points, then ruin and recreate, while a second thread proves a bound.

    The search saves one build after another (see `RuinAndRecreate`). Meanwhile `CoveringBound` raises the bound. Both
    budgets are used in full unless the two meet, so the result does not depend on the clock.
    """
    runner = PassRunner(instance)
    bound = builds_bound(instance)
    best, reason = _construct(runner, bound, params, stop)
    if reason or not best.complete or best.rank[0]:
        return PackerResult(best.arrangement, float(bound), reason or "finished", best.complete)
    search = RuinAndRecreate(runner, best.arrangement, params, rng)
    with _proof(CoveringBound(instance, bound), search, params, stop) as proof:
        while not reason:
            fraction = min(float(search.spent[0]) / (params.work * 1e6 + 1.0), 1.0)
            progress(fraction, f"{search.builds} builds, bound {proof.builds}")
            reason = search.save_a_build(lambda: proof.builds, stop)
    # the proof may go on after the search has ended; the result must not depend on which ends first
    reason = "bound met" if search.builds <= proof.builds else reason
    return PackerResult(search.best, float(proof.builds), reason)


@contextmanager
def _proof(
    proof: CoveringBound, search: RuinAndRecreate, params: AutoParams, stop: Stop
) -> Iterator[CoveringBound]:
    """Prove a bound in a second thread; leave when it is done, or at once when told to stop."""
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


def _construct(runner: PassRunner, bound: int, params: AutoParams, stop: Stop) -> tuple[PassResult, str]:
    """Return the best of the passes, and the reason to stop with it or "" to go on.

    Half of the work is left for the search.
    """
    passes = constructive_passes(runner.instance)
    best = runner.run(passes[0], None, stop)
    for tried in passes[1:]:
        if _meets(best, bound):
            return best, "bound met"
        if stop():
            return best, stop.reason
        if runner.work > params.work * 0.5e6:
            return best, ""
        best = min(best, runner.run(tried, best, stop), key=lambda result: result.rank)
    return best, "bound met" if _meets(best, bound) else ""


def _meets(result: PassResult, bound: int) -> bool:
    """Return whether every item is placed, in no more builds than the bound."""
    return result.complete and result.rank[0] == 0.0 and result.rank[1] <= bound
