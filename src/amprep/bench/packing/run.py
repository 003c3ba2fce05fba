"""Runs a packer over benchmark instances; the judge looks at every answer."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.bench.packing.instances import Instance
from amprep.checks.packing.volumes_placed import check_packing
from amprep.geometry.boxes.build_space import union_volume
from amprep.host import Host
from amprep.model import Boxes, PackingProblem, Stop, silent
from amprep.model.packing import Packing

if TYPE_CHECKING:
    from amprep.hookspecs import Packer
    from amprep.host import Listed

UNLIMITED: dict[str, float] = {"work": 1e12, "patience": 10**9, "effort": 1e12, "proof": 1e12}
"""Parameters that end a packer before its time."""


@dataclass(frozen=True)
class Result:
    """What a packer made of one instance.

    Attributes
    ----------
    measure
        ``bins`` for the fewest builds, ``value`` for the greatest value.
    reached, bound
        The number of builds or the value, and what cannot be beaten.
    share
        Filled share of the builds' volume.
    faults
        What the judge has to say against it; none in a valid answer.
    """

    name: str
    measure: str
    reached: float
    bound: float | None
    share: float
    unplaced: int
    status: str
    stop_reason: str
    seconds: float
    faults: tuple[str, ...]

    @property
    def validated(self) -> bool:
        """Whether the judge found nothing."""
        return not self.faults

    @property
    def record(self) -> dict[str, Any]:
        """The result as JSON can hold it."""
        whole = int(self.reached) if self.measure == "bins" else self.reached
        return {
            "name": self.name,
            self.measure: whole,
            "bound": self.bound,
            "share": round(self.share, 6),
            "unplaced": self.unplaced,
            "status": self.status,
            "stop_reason": self.stop_reason,
            "seconds": round(self.seconds, 3),
            "validated": self.validated,
            "faults": list(self.faults),
        }

    @property
    def line(self) -> str:
        """The result in a line."""
        bound = "unknown" if self.bound is None else f"{self.bound:g}"
        verdict = "valid" if self.validated else f"INVALID: {self.faults[0]}"
        return (
            f"{self.name}: {self.measure} {self.reached:g}, bound {bound}, filled {self.share:.1%}, "
            f"{self.status} ({self.stop_reason}), {self.seconds:.2f} s, {verdict}"
        )


def run_instances(
    instances: Sequence[Instance],
    packer: str,
    *,
    seconds: float,
    seed: int,
    progress: Callable[[Result], None],
) -> list[Result]:
    """Run a packer on each instance for at most `seconds`; a budget counted in work is lifted.

    The first instance is packed for a second or so before, so that no time counts that goes into loading
    or compiling.

    Raises
    ------
    PluginError
        For an unknown packer, or one that does not accept such problems.
    """
    host = Host.load()
    listed = host.choose("packer", packer)
    for instance in instances[:1]:
        _warm_up(host, listed, instance.problem, min(seconds, 2.0))
    results = []
    for instance in instances:
        results.append(_run(host, listed, instance, {}, seconds=seconds, seed=seed))
        progress(results[-1])
    return results


def run_one(
    host: Host, packer: str, instance: Instance, table: dict[str, Any], *, seconds: float, seed: int
) -> Result:
    """Run a packer with parameters of its own on one instance, warm."""
    listed = host.choose("packer", packer)
    _warm_up(host, listed, instance.problem, min(seconds, 2.0))
    return _run(host, listed, instance, table, seconds=seconds, seed=seed)


def _run(
    host: Host,
    listed: "Listed[Packer]",
    instance: Instance,
    table: dict[str, Any],
    *,
    seconds: float,
    seed: int,
) -> Result:
    """Run a packer and let the judge look at the answer."""
    host.refuse_mismatch(listed, instance.problem)
    start = time.monotonic()
    packing = _pack(host, listed, instance.problem, table, seconds=seconds, seed=seed)
    took = time.monotonic() - start
    return _result(instance, packing, took)


def means(results: Sequence[Result]) -> dict[str, float]:
    """Return the means of what was reached, of the bounds known, of the share filled and of the time."""
    if not results:
        return {}
    found = {results[0].measure: float(np.mean([result.reached for result in results]))}
    bounds = [result.bound for result in results if result.bound is not None]
    if len(bounds) == len(results):
        found["bound"] = float(np.mean(bounds))
    found["share"] = float(np.mean([result.share for result in results]))
    found["seconds"] = float(np.mean([result.seconds for result in results]))
    return found


def _warm_up(host: Host, listed: "Listed[Packer]", problem: PackingProblem, seconds: float) -> None:
    """Pack again and again until it takes no longer than it should: then all is loaded and compiled."""
    for _ in range(5):
        start = time.monotonic()
        _pack(host, listed, problem, {}, seconds=seconds, seed=0)
        if time.monotonic() - start < seconds + 0.5:
            return


def _pack(
    host: Host,
    listed: "Listed[Packer]",
    problem: PackingProblem,
    table: dict[str, Any],
    *,
    seconds: float,
    seed: int,
) -> Packing:
    known = {field.name for field in fields(listed.offer.params)}
    lifted = {name: most for name, most in UNLIMITED.items() if name in known}
    params = host.params(listed, lifted | table)
    rng, stop = np.random.default_rng(seed), Stop.after(seconds)
    return host.call(listed, problem, params=params, rng=rng, stop=stop, progress=silent)


def _result(instance: Instance, packing: Packing, seconds: float) -> Result:
    problem = instance.problem
    placed = [placement.item for build in packing.builds for placement in build]
    filling = problem.objective == "fill"
    worth = sum(problem.items[item].value for item in placed)
    volume = sum(_volume(problem, item) for item in placed)
    room = problem.space.volume_mm3 * max(len(packing.builds), 1)
    return Result(
        instance.name,
        "value" if filling else "bins",
        worth if filling else float(len(packing.builds)),
        packing.bound,
        volume / room,
        len(packing.unplaced),
        packing.status,
        packing.stop_reason,
        seconds,
        tuple(
            f"{fault.promise}: {fault.subject} {fault.message}" for fault in check_packing(problem, packing)
        ),
    )


def _volume(problem: PackingProblem, item: int) -> float:
    """Return the volume of an item's union of boxes."""
    volume = problem.items[item].volume
    return union_volume(volume.lo, volume.hi) if isinstance(volume, Boxes) else 0.0
