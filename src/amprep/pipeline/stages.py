"""Stages of a run: their names, their seconds, and whoever watches them."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol

from amprep.model import Progress, silent
from amprep.report.record import StageTime


class Watcher(Protocol):
    """Shows a person what is going on; the command line draws bars, tests watch nothing."""

    def stage(self, name: str) -> AbstractContextManager[Progress]:
        """Enter a stage; the yielded function takes the share done and a few words."""
        ...


class Unwatched:
    """A watcher that shows nothing."""

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:  # noqa: ARG002 - as a `Watcher` is called
        """Yield a report nobody reads."""
        yield silent


class Clock:
    """Times stages; a stage entered again adds to its seconds."""

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher
        self._seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """Time and show one stage."""
        began = time.perf_counter()
        try:
            with self._watcher.stage(name) as progress:
                yield progress
        finally:
            self._seconds[name] = self._seconds.get(name, 0.0) + time.perf_counter() - began

    @property
    def times(self) -> tuple[StageTime, ...]:
        """Seconds of each stage, in order of first entry."""
        return tuple(StageTime(name, seconds) for name, seconds in self._seconds.items())
