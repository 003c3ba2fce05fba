"""Progress bars on standard error, one for each stage."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self

from amprep.model.control import Progress

if TYPE_CHECKING:
    from rich.console import Console


class Bars:
    """Draws a bar a stage; on something that is no terminal, a line when a stage ends."""

    def __init__(self, console: "Console") -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        self._console = console
        self._progress = Progress(
            TextColumn("{task.description:>10}"),
            BarColumn(bar_width=28),
            TimeElapsedColumn(),
            TextColumn("[dim]{task.fields[words]}", markup=True),
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
        """Show one stage; entered again, it goes on with the same bar."""
        from rich.markup import escape
        from rich.progress import TaskID

        if name not in self._tasks:
            self._tasks[name] = self._progress.add_task(name, total=1.0, words="")
        task = TaskID(self._tasks[name])

        def progress(share: float, words: str) -> None:
            self._progress.update(task, completed=min(max(share, 0.0), 1.0), words=escape(words))

        progress(0.0, "")
        yield progress
        progress(1.0, "")
