"""The progress of a run on standard error: bars for people, lines of JSON for programs."""

import json
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from amprep.cli.log import Log
from amprep.model.control import Progress

if TYPE_CHECKING:
    from rich.console import Console


class Bars:
    """Draws one bar per stage; if the output is not a terminal, it prints one line per finished stage."""

    def __init__(self, console: "Console", log: Log = lambda _: None) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        self._console, self._log = console, log
        self._progress = Progress(
            TextColumn("{task.description:>10}"),
            BarColumn(bar_width=28),
            TimeElapsedColumn(),
            TextColumn("[dim]{task.fields[message]}", markup=True),
            console=console,
        )
        self._tasks: dict[str, int] = {}

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """Show one stage; a stage that is entered again continues its bar."""
        from rich.markup import escape
        from rich.progress import TaskID

        if name not in self._tasks:
            self._tasks[name] = self._progress.add_task(name, total=1.0, message="")
        task = TaskID(self._tasks[name])

        def show(fraction: float, message: str) -> None:
            self._progress.update(task, completed=min(max(fraction, 0.0), 1.0), message=escape(message))

        with _logged(name, show, self._log) as progress:
            yield progress


class Lines:
    """Prints a line of JSON where a stage begins or ends, its message changes, or another percent is done.

    The keys are ``stage``, ``fraction`` (in [0, 1], of the stage) and ``message``.
    """

    def __init__(self, log: Log = lambda _: None) -> None:
        self._log = log

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Nothing is to be closed."""

    @contextmanager
    def stage(self, name: str) -> Iterator[Progress]:
        """Print the progress of one stage."""
        last: tuple[float, str] | None = None

        def show(fraction: float, message: str) -> None:
            nonlocal last
            step = round(min(max(fraction, 0.0), 1.0), 2), message
            if step != last:
                last = step
                _print_line({"stage": name, "fraction": step[0], "message": message})

        with _logged(name, show, self._log) as progress:
            yield progress


@contextmanager
def _logged(name: str, show: Progress, log: Log) -> Iterator[Progress]:
    """Yield a callback for one stage that shows its progress, and log its messages and its duration."""
    last = ""

    def progress(fraction: float, message: str) -> None:
        nonlocal last
        if message and message != last:
            log(f"{name}: {message}")
            last = message
        show(fraction, message)

    begin = time.monotonic()
    progress(0.0, "")
    yield progress
    progress(1.0, "")
    log(f"{name}: done in {time.monotonic() - begin:.2f} s")


def _print_line(values: dict[str, Any]) -> None:
    sys.stderr.write(json.dumps(values) + "\n")
    sys.stderr.flush()
