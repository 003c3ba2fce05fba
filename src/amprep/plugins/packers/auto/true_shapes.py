"""True shapes after boxes: the packing of enclosing boxes first, then what packers of true shapes gain."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from amprep.measures.objective import objective_reached
from amprep.measures.parts_bound import parts_bound
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, PackingStep, Status
from amprep.plugins.packers.auto.lists import in_lists
from amprep.plugins.packers.auto.lower_builds import heights_of, lower_builds
from amprep.plugins.packers.bounds.reasons import with_proved_reasons
from amprep.plugins.packers.extreme_points import construct
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import AutoParams, ExtremePointsParams, PlatesParams, SeparationParams

PackBoxes = Callable[..., PackerResult]
"""`amprep.plugins.packers.auto.pack_boxes`."""

BOXES_FRACTION = 0.2
"""Fraction of the time for the enclosing boxes."""

BUILDS_FRACTION = 0.7
"""Fraction of the work and time for few builds; the rest is for low ones."""

UNLIMITED = 1e9
"""Work where a time limit is given, which is then used."""

MET = 1e-9
"""Fraction of the objective that is rounding."""

# Strategy. Boxes take milliseconds and are often proved best for the true shapes too: a single build always is, and so
# is a height that equals that of the highest part. Then nothing else is done, and no kernel for true shapes is
# compiled. Otherwise `separation` or `plates` packs the true shapes, and the better packing counts. With stacking, each
# build is then packed again, as low as possible.


def pack_true_shapes(
    problem: PackingProblem,
    pack_boxes: PackBoxes,
    *,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack enclosing boxes, then the true shapes, and return the better packing with a record of the steps."""
    if stop.deadline is not None:
        params = replace(params, separation=_unlimited(params.separation), plates=_unlimited(params.plates))
    improved = Improvement(problem, stop, progress)
    improved.add("enclosing boxes", lambda: _of_boxes(problem, pack_boxes, params, rng, stop, progress))
    lowering = problem.objective == "builds" and problem.stacking
    work = params.separation if problem.stacking else params.plates
    if work > 0.0 and not improved.ends():
        fraction = BUILDS_FRACTION if lowering else 1.0
        part = _part(stop, fraction)
        improved.add("true shapes", lambda: _of_shapes(problem, fraction * work, rng, part, progress))
    if lowering and not stop():
        improved.add(
            "lower builds", lambda: lower_builds(problem, improved.best, pack_boxes, params, rng, stop)
        )
    return improved.packing()


class Improvement:
    """The best packing so far, its bound for the true shapes, and the steps that led to it."""

    def __init__(self, problem: PackingProblem, stop: Stop, progress: Progress) -> None:
        self.problem, self.stop, self.progress = problem, stop, progress
        self.best = Packing(())
        self.bound = np.nan
        self.steps: list[PackingStep] = []

    def add(self, method: str, step: Callable[[], Packing]) -> None:
        """Do a step; its packing counts if it is better. A step that returns the best packing itself did nothing."""
        begun = time.monotonic()
        self.progress(0.0, method)
        found = with_proved_reasons(self.problem, step())
        if found is self.best:
            return
        if not self.steps:
            too_large = [each.item for each in found.unplaced if each.reason == "too large"]
            self.bound = parts_bound(self.problem, too_large)
        if not self.steps or self._rank(found) < self._rank(self.best):
            self.best = found
        reached, height = objective_reached(self.problem, self.best), max(heights_of(self.problem, self.best))
        self.steps.append(PackingStep(method, reached, height, time.monotonic() - begun))

    def ends(self) -> bool:
        """Return whether the best packing cannot be better, or there is no time to make it better."""
        return self._is_optimal() or self._all_but_too_large() or self.stop()

    def _all_but_too_large(self) -> bool:
        """Return whether the bound is met without items whose enclosing boxes are too large for a box-shaped build."""
        space = self.problem.space
        if self.problem.objective == "fill" or space.shape == "cylinder" or len(space.zone_lo):
            return False
        left = any(each.reason != "too large" for each in self.best.unplaced)
        reached = objective_reached(self.problem, self.best)
        return not left and reached <= self.bound + MET * max(1.0, reached)

    def packing(self) -> Packing:
        """Return the best packing with the bound for true shapes and all steps."""
        optimal = self._is_optimal()
        bound = objective_reached(self.problem, self.best) if optimal else self.bound  # without rounding
        left: Status = "infeasible" if self.best.status == "infeasible" else "feasible"
        reason = "bound met" if optimal else self.stop.reason if self.stop() else "finished"
        return replace(
            self.best,
            bound=bound,
            bound_for=self.problem.bound_for,
            status="optimal" if optimal else left,
            stop_reason=reason,
            steps=tuple(self.steps),
        )

    def _is_optimal(self) -> bool:
        """Return whether all items are placed (or all that have a value) and the bound is met."""
        reached = objective_reached(self.problem, self.best)
        slack = MET * max(1.0, abs(reached))
        if self.problem.objective == "fill":
            return reached >= self.bound - slack
        return not self.best.unplaced and reached <= self.bound + slack

    def _rank(self, packing: Packing) -> tuple[float, ...]:
        """Return a rank, smaller for a better packing: all placed, the objective, the sum of heights."""
        reached, total = objective_reached(self.problem, packing), sum(heights_of(self.problem, packing))
        if self.problem.objective == "fill":
            return (-reached, total)
        return (float(len(packing.unplaced)), reached, total)


def _of_boxes(
    problem: PackingProblem,
    pack_boxes: PackBoxes,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Return a packing of the enclosing boxes: by `extreme-points`, and where it has many builds, by searching on."""
    instance = prepare(in_lists(problem), enclosing=True)
    early = _part(stop, BOXES_FRACTION)
    found = None
    if problem.objective == "builds":
        plain = ExtremePointsParams()
        found = as_packing(
            instance, construct(instance, params=plain, rng=rng, stop=early, progress=progress)
        )
        if found.status != "feasible" or early():
            return found
    budget = replace(params, work=params.boxes * params.work, proof=params.boxes * params.proof)
    searched = as_packing(
        instance, pack_boxes(instance, params=budget, rng=rng, stop=early, progress=progress)
    )
    return found if found is not None and len(searched.builds) >= len(found.builds) else searched


def _of_shapes(
    problem: PackingProblem, work: float, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Return a packing of the true shapes: by `separation`, or without stacking by `plates`."""
    if not problem.stacking:
        from amprep.plugins.packers.plates import pack_plates

        plates = PlatesParams(work=work)
        return pack_plates(problem, params=plates, rng=rng, stop=stop, progress=progress)
    from amprep.plugins.packers.separation import pack_separation

    shapes = SeparationParams(work=work)
    return pack_separation(in_lists(problem), params=shapes, rng=rng, stop=stop, progress=progress)


def _unlimited(work: float) -> float:
    """Return work for all of the time; none stays none."""
    return UNLIMITED if work > 0.0 else 0.0


def _part(stop: Stop, fraction: float) -> Stop:
    """Return a stop for a fraction of the time that is left."""
    return stop if stop.deadline is None else stop.within(fraction * stop.remaining())
