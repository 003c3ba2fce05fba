"""Progress bars on standard error, one per stage."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self

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

        last = ""

        def progress(fraction: float, message: str) -> None:
            nonlocal last
            if message and message != last:
                self._log(f"{name}: {message}")
                last = message
            self._progress.update(task, completed=min(max(fraction, 0.0), 1.0), message=escape(message))

        begin = time.monotonic()
        progress(0.0, "")
        yield progress
        progress(1.0, "")
        self._log(f"{name}: done in {time.monotonic() - begin:.2f} s")
