"""Run a packer on benchmark instances and check each packing independently."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.bench.measuring import Spent, measured
from amprep.checks.packing.volumes_placed import check_packing
from amprep.host import Host
from amprep.measures.bounding_volume import volume_of
from amprep.measures.objective import objective_reached
from amprep.model import PackingProblem, Stop, silent
from amprep.model.packing import Packing
from amprep.testing.packing_instances import PackingInstance

if TYPE_CHECKING:
    from amprep.hookspecs import Packer
    from amprep.host import Listed

UNLIMITED: dict[str, float] = {
    "work": 1e12,
    "patience": 10**9,
    "effort": 1e12,
    "proof": 1e12,
    "failures": 10**9,
}
"""Parameters that would end a packer before the time limit, and values that never do."""

_MEASURES = {"builds": "builds", "fill": "value", "height": "height_mm"}
"""Objective -> what a result reaches."""


@dataclass(frozen=True)
class PackingResult:
    """The packing of one instance in figures.

    Attributes
    ----------
    measure
        ``builds`` (fewer is better), ``value`` (more is better) or ``height_mm`` (less is better).
    reached, bound
        Value of the objective, and a proven bound on it.
    fill_ratio
        See the function `fill_ratio`.
    faults
        Violations that the independent check found.
    found_by
        The method that found the packing, where the packer has several.
    processor_seconds
        Processor time of all threads.
    """

    name: str
    measure: str
    reached: float
    bound: float | None
    fill_ratio: float
    unplaced: int
    status: str
    stop_reason: str
    seconds: float
    faults: tuple[str, ...]
    found_by: str = ""
    processor_seconds: float = 0.0

    @property
    def validated(self) -> bool:
        """Whether the independent check found no violation."""
        return not self.faults

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        reached = int(self.reached) if self.measure == "builds" else self.reached
        return {
            "name": self.name,
            self.measure: reached,
            "bound": self.bound,
            "fill_ratio": round(self.fill_ratio, 6),
            "unplaced": self.unplaced,
            "status": self.status,
            "stop_reason": self.stop_reason,
            "found_by": self.found_by,
            "seconds": round(self.seconds, 3),
            "processor_seconds": round(self.processor_seconds, 3),
            "validated": self.validated,
            "faults": list(self.faults),
        }

    @property
    def line(self) -> str:
        """The result in one line."""
        bound = "unknown" if self.bound is None else f"{self.bound:g}"
        verdict = "valid" if self.validated else f"INVALID: {self.faults[0]}"
        return (
            f"{self.name}: {self.measure} {self.reached:g}, bound {bound}, filled {self.fill_ratio:.1%}, "
            f"{self.status} ({self.stop_reason}), {self.seconds:.2f} s, {verdict}"
            + (f", found by {self.found_by}" if self.found_by else "")
        )


@dataclass(frozen=True)
class PackerRun:
    """A packer with its parameters, a time limit per instance (s) and a seed."""

    host: Host
    packer: "Listed[Packer]"
    params: dict[str, Any]
    seconds: float
    seed: int

    def warm_up(self, problem: PackingProblem) -> None:
        """Pack a problem with default parameters until everything is imported and compiled."""
        brief = replace(self, params={}, seconds=min(self.seconds, 2.0), seed=0)
        for _ in range(5):
            start = time.monotonic()
            brief.pack(problem)
            if time.monotonic() - start < brief.seconds + 0.5:
                return

    def run(self, instance: PackingInstance) -> PackingResult:
        """Pack an instance and check the packing."""
        self.host.refuse_mismatch(self.packer, instance.problem)
        packing, spent = measured(lambda: self.pack(instance.problem))
        return _result(instance, packing, spent)

    def pack(self, problem: PackingProblem) -> Packing:
        """Pack a problem; only the time limit and the packer itself end the search."""
        known = {field.name: field.default for field in fields(self.packer.offer.params)}
        unlimited = {name: value for name, value in UNLIMITED.items() if known.get(name) is not None}
        params = self.host.params(self.packer, unlimited | self.params)
        rng, stop = np.random.default_rng(self.seed), Stop.after(self.seconds)
        return self.host.call(self.packer, problem, params=params, rng=rng, stop=stop, progress=silent)


def run_instances(
    instances: Sequence[PackingInstance],
    packer: str,
    *,
    seconds: float,
    seed: int,
    progress: Callable[[PackingResult], None],
) -> list[PackingResult]:
    """Run a packer on each instance; limits on the amount of work are lifted.

    The first instance is packed once more beforehand, so that importing and compiling are not measured.

    Parameters
    ----------
    instances
        The instances.
    packer
        Name of the packer.
    seconds
        Time limit per instance.
    seed
        Seed of the packer's random numbers.
    progress
        Called with each result.

    Raises
    ------
    PluginError
        If the packer is unknown or does not accept such problems.
    """
    host = Host.load()
    run = PackerRun(host, host.choose("packer", packer), {}, seconds, seed)
    for instance in instances[:1]:
        run.warm_up(instance.problem)
    results = []
    for instance in instances:
        results.append(run.run(instance))
        progress(results[-1])
    return results


def means(results: Sequence[PackingResult]) -> dict[str, float]:
    """Return the means of the objective, the bound (if known for all), the fill ratio and the time."""
    if not results:
        return {}
    found = {results[0].measure: float(np.mean([result.reached for result in results]))}
    bounds = [result.bound for result in results if result.bound is not None]
    if len(bounds) == len(results):
        found["bound"] = float(np.mean(bounds))
    found["fill_ratio"] = float(np.mean([result.fill_ratio for result in results]))
    found["seconds"] = float(np.mean([result.seconds for result in results]))
    return found


def fill_ratio(problem: PackingProblem, packing: Packing) -> float:
    """Return the volume of the placed bounding volumes over the volume of the builds used.

    Overlaps of the boxes, pieces or shells of an item count once; copies share their volume, which is measured once.
    """
    placed = [problem.items[placement.item].volume for build in packing.builds for placement in build]
    measured = {id(volume): volume_of(volume) for volume in {id(each): each for each in placed}.values()}
    total = sum(measured[id(volume)] for volume in placed)
    return total / (problem.space.volume_mm3 * max(len(packing.builds), 1))


def _result(instance: PackingInstance, packing: Packing, spent: Spent) -> PackingResult:
    problem = instance.problem
    return PackingResult(
        name=instance.name,
        measure=_MEASURES[problem.objective],
        reached=objective_reached(problem, packing),
        bound=packing.bound,
        fill_ratio=fill_ratio(problem, packing),
        unplaced=len(packing.unplaced),
        status=packing.status,
        stop_reason=packing.stop_reason,
        seconds=spent.seconds,
        processor_seconds=spent.process_seconds,
        faults=tuple(map(str, check_packing(problem, packing))),
        found_by=packing.found_by,
    )
