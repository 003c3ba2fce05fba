"""Time the stages of a run, report their progress, and say when they must end."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import NamedTuple, Protocol

from amprep import interruption
from amprep.model import Progress, Stop, silent
from amprep.report.record import StageTime


class Watcher(Protocol):
    """Shows the progress of a run, stage by stage; the command line draws one bar per stage."""

    def stage(self, name: str) -> AbstractContextManager[Progress]:
        """Enter a stage and yield the callback that shows its progress."""
        ...


class ProgressWatcher:
    """Watcher that passes the progress of every stage on to one callback.

    Parameters
    ----------
    progress
        Called with the fraction of the stage that is done, and a message that begins with the name of the stage.
    """

    def __init__(self, progress: Progress = silent) -> None:
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """Enter a stage and yield the callback that shows its progress."""
        yield lambda fraction, message: self._progress(fraction, f"{name}: {message}")


class Clock:
    """Measures the seconds that each stage takes; a stage that is entered again adds to its time."""

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher
        self._seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """Time and show one stage."""
        interruption.raise_lost()
        began = time.perf_counter()
        try:
            with self._watcher.stage(name) as progress:
                yield progress
        finally:
            self._seconds[name] = self._seconds.get(name, 0.0) + time.perf_counter() - began

    @property
    def times(self) -> tuple[StageTime, ...]:
        """Seconds that each stage took, in the order in which the stages were first entered."""
        return tuple(StageTime(name, seconds) for name, seconds in self._seconds.items())


LEAST_BUILDING = 30.0
"""Seconds that making supports solid may take at least after a time limit has ended their routing."""


class SupportStops(NamedTuple):
    """When to end the routing of supports, to leave out supports that are not finished, and to end the judges."""

    routing: Stop
    building: Stop
    judging: Stop

    @classmethod
    def after(cls, seconds: float | None, stop: Stop) -> "SupportStops":
        """Return stops after a time limit (None for none), and twice after as long again, at least `LEAST_BUILDING`."""
        if seconds is None:
            return cls(stop, stop, stop)
        more = max(seconds, LEAST_BUILDING)
        return cls(stop.within(seconds), stop.within(seconds + more), stop.within(seconds + 2.0 * more))
