"""Searches from several seeds, side by side on the workers; the best packing counts."""

import mmap
import os
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import replace
from threading import Event
from typing import Any

import numpy as np

from amprep import workers
from amprep.arrays import Floats
from amprep.hookspecs import Pack
from amprep.measures.objective import greatest_height, objective_reached
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem

_LONG = 1e6
"""Work of one start: each gets a process of its own."""

# Strategy. Each start has random numbers of its own, the first one those of the packer without further starts. So the
# packings do not depend on the number of processes. A start that proves its packing the best ends those after it,
# whether they have begun or not: theirs do not count. Forked processes do not see what happens in this one, so
# the cancellation, the proofs and the progress of all starts are in memory that they share.


def with_starts(pack: Callable[..., Packing]) -> Pack:
    """Return a packer that runs another one as often as its parameter `starts` says, and keeps the best packing."""

    def run(
        problem: PackingProblem, *, params: Any, rng: np.random.Generator, stop: Stop, progress: Progress
    ) -> Packing:
        if params.starts == 1:
            return pack(problem, params=params, rng=rng, stop=stop, progress=progress)
        state = _SharedState(params.starts, stop, progress)
        generators, alone = _generators(rng, params.starts), replace(params, starts=1)

        def start(number: int) -> Packing | None:
            if state.is_needless(number):
                return None
            packing = pack(
                problem,
                params=alone,
                rng=generators[number],
                stop=state.stop_of(number),
                progress=state.progress_of(number),
            )
            state.note(number, proved=_is_proved(problem, packing))
            return packing

        work = [_LONG] * params.starts
        return _best(problem, workers.share_out(start, work, all_long=True, is_cancelled=state.pass_on))

    return run


class _SharedState:
    """What the processes of all starts tell one another.

    Attributes
    ----------
    fractions
        Fraction of each start that is done ``(n,)``.
    proved
        1 for each start that proved its packing the best ``(n,)``.
    cancelled
        1 if the user interrupted ``(1,)``.
    """

    def __init__(self, starts: int, stop: Stop, progress: Progress) -> None:
        shared = np.frombuffer(mmap.mmap(-1, 8 * (2 * starts + 1)), np.float64)
        self.fractions, self.proved, self.cancelled = np.split(shared, [starts, 2 * starts])
        self.starts, self.stop, self.progress, self.process = starts, stop, progress, os.getpid()
        self.processes = workers.usable(starts)

    def is_needless(self, number: int) -> bool:
        """Tell whether a start cannot count any more: one before it has proved its packing, or all are to end."""
        return bool(self.proved[:number].any()) or (number > 0 and self.stop_of(number)())

    def stop_of(self, number: int) -> Stop:
        """Return the stop of a start: where starts come one after another, they divide the time among them."""
        ended = _Ended(self.stop.cancelled, self.cancelled, self.proved[:number])
        stop = Stop(self.stop.deadline, ended)
        if stop.deadline is None:
            return stop
        rounds = -(-self.starts // self.processes) - number // self.processes
        return stop.within(stop.remaining() / rounds)

    def progress_of(self, number: int) -> Progress:
        """Return the progress of a start, which becomes that of all."""

        def progress(fraction: float, message: str) -> None:
            self.fractions[number] = fraction
            if os.getpid() == self.process:
                self.progress(float(self.fractions.mean()), f"start {number + 1} of {self.starts}: {message}")

        return progress

    def note(self, number: int, *, proved: bool) -> None:
        """Note that a start is done."""
        self.fractions[number], self.proved[number] = 1.0, proved

    def pass_on(self) -> bool:
        """Tell the other processes of a cancellation, and show their progress; never ask for an end without answers."""
        self.cancelled[0] = self.stop.cancelled.is_set()
        self.progress(float(self.fractions.mean()), f"best of {self.starts} starts")
        return False


class _Ended(Event):
    """Set when the user interrupts, in any process, or when an earlier start proved its packing the best."""

    def __init__(self, cancelled: Event, shared: Floats, proved_before: Floats) -> None:
        super().__init__()
        self.cancelled, self.shared, self.proved_before = cancelled, shared, proved_before

    def is_set(self) -> bool:
        return self.cancelled.is_set() or bool(self.shared[0]) or bool(self.proved_before.any())


def _generators(rng: np.random.Generator, count: int) -> list[np.random.Generator]:
    """Return the random numbers of each start: the first are those of the packer, the others follow from them."""
    seeds = deepcopy(rng).integers(2**63, size=count - 1)
    return [rng, *map(np.random.default_rng, seeds.tolist())]


def _is_proved(problem: PackingProblem, packing: Packing) -> bool:
    """Tell whether no other packing can be better; as few builds, stacked, may still be lower."""
    return packing.status == "optimal" and not (problem.objective == "builds" and problem.stacking)


def _best(problem: PackingProblem, found: Sequence[Packing | None]) -> Packing:
    """Return the best packing; of equal ones, and after a proof, the first one."""
    made = [packing for packing in found if packing is not None]
    proved = next((n for n, packing in enumerate(made) if _is_proved(problem, packing)), len(made))
    return min(made[: proved + 1], key=lambda packing: _rank(problem, packing))


def _rank(problem: PackingProblem, packing: Packing) -> tuple[float, ...]:
    """Return what is less for a better packing: items left out, the objective, the height of all builds together."""
    reached, height = (
        objective_reached(problem, packing),
        sum(greatest_height(problem, b) for b in packing.builds),
    )
    return (-reached, height) if problem.objective == "fill" else (len(packing.unplaced), reached, height)
