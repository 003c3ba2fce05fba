"""Workers that search side by side and share their best layouts."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from threading import Condition
from typing import NamedTuple

from amprep.model.control import silent
from amprep.plugins.packers.separation.state import UNLIMITED, Placed, Scene, WorkBudget, nothing_placed

# Strategy. Each worker is a thread with its own random numbers and work arrays; kernels and linear programs release
# the interpreter lock. The clock of a worker is the work that it has done. A layout that one publishes at clock c
# reaches the others at their clock c + DELAY. A worker waits until the others have passed its own clock less DELAY:
# then it has all layouts that it may know. So what a worker does depends on the seed and on work alone, not on time.
# Clocks advance at nearly the same speed, and the delay absorbs the difference: workers hardly wait. With a time
# limit and no limit of work the result depends on time in any case, and layouts are delivered at once.

DELAY = 200e6
"""Work after which another worker knows a layout, some tenths of a second."""

WAIT = 0.05
"""Seconds between two looks at the stop while a worker waits."""


class SharedLayout(NamedTuple):
    """A layout, its value (less is better), and who found it at which clock."""

    value: float
    clock: float
    worker: int
    placed: Placed


@dataclass(eq=False)
class Exchange:
    """Clocks of all workers and the layouts that they have published."""

    clocks: list[float]
    delay: float
    goal: float
    shared: list[SharedLayout] = field(default_factory=list)
    changed: Condition = field(default_factory=Condition)

    def publish(self, layout: SharedLayout) -> None:
        """Add a layout."""
        with self.changed:
            self.shared.append(layout)
            self.changed.notify_all()

    def advance(self, worker: int, clock: float, stopped: Callable[[], bool]) -> None:
        """Set the clock of a worker and wait until no other one is behind by `DELAY` or more."""
        with self.changed:
            self.clocks[worker] = clock
            self.changed.notify_all()
            while self._behind(clock) and not stopped():
                self.changed.wait(WAIT)

    def leave(self, worker: int) -> None:
        """Let nobody wait for a worker any more."""
        self.advance(worker, float("inf"), lambda: True)

    def best(self, worker: int = -1, clock: float = float("inf")) -> SharedLayout | None:
        """Return the best layout that is known to a worker at a clock; of equals the first one."""
        with self.changed:
            known = [s for s in self.shared if s.worker == worker or s.clock <= clock - self.delay]
        return min(known, key=lambda s: s[:3], default=None)

    def done(self, clock: float) -> bool:
        """Tell whether a layout that reaches the goal was found before a clock: a later one would not count."""
        with self.changed:
            return any(s.value <= self.goal and s.clock <= clock for s in self.shared)

    def _behind(self, clock: float) -> bool:
        if self.delay <= 0.0 or any(s.value <= self.goal and s.clock <= clock for s in self.shared):
            return False
        return min(self.clocks) <= clock - self.delay


@dataclass(frozen=True, eq=False)
class SearchWorker:
    """One of the workers: its number, the problem with its own random numbers and budget, and the exchange."""

    number: int
    scene: Scene
    exchange: Exchange

    def publish(self, value: float, placed: Placed) -> None:
        """Share a layout; values up to the goal are equal."""
        clock = self.scene.budget.spent
        self.exchange.publish(SharedLayout(max(value, self.exchange.goal), clock, self.number, placed))

    def better_than(self, value: float) -> SharedLayout | None:
        """Return a layout of less value than a given one if another worker has shared it."""
        budget = self.scene.budget
        self.exchange.advance(self.number, budget.spent, budget.stopped)
        found = self.exchange.best(self.number, budget.spent)
        return found if found is not None and found.value < value else None

    def knows_better(self, value: float) -> bool:
        """Tell whether another worker has shared a layout of less value."""
        return self.better_than(value) is not None

    def over(self) -> bool:
        """Tell whether to end: the budget is used up, or the goal is reached."""
        return self.scene.budget.over() or self.exchange.done(self.scene.budget.spent)


def run_workers(scene: Scene, goal: float, search: Callable[[SearchWorker], None]) -> Placed:
    """Run a search in each worker; return the layout of least value that was published.

    Parameters
    ----------
    scene
        Its budget is divided among the workers.
    goal
        Value at which the search ends: no layout is better, or none counts as better.
    search
        Called in one thread per worker, for the first worker in the thread of the caller.
    """
    count = scene.params.workers
    exchange = Exchange([0.0] * count, 0.0 if scene.budget.timed else DELAY, goal)
    generators = scene.rng.spawn(count)
    whole = scene.budget
    part = UNLIMITED if whole.timed else whole.left / count
    budgets = [WorkBudget(whole.stop, part, ended=whole.ended) for _ in range(count)]
    workers = [
        SearchWorker(
            k, replace(scene, rng=rng, budget=budget, progress=silent if k else scene.progress), exchange
        )
        for k, (rng, budget) in enumerate(zip(generators, budgets, strict=True))
    ]

    def run(worker: SearchWorker) -> None:
        try:
            search(worker)
        except BaseException:
            whole.ended.set()
            raise
        finally:
            exchange.leave(worker.number)

    with ThreadPoolExecutor(max(count - 1, 1)) as pool:
        others = [pool.submit(run, worker) for worker in workers[1:]]
        run(workers[0])
    for other in others:
        other.result()
    scene.budget.left -= sum(budget.spent for budget in budgets)
    best = exchange.best()
    return nothing_placed() if best is None else best.placed
