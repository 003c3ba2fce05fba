"""Run amprep as a process: progress from standard error, the report from standard output, and cancelling."""

from __future__ import annotations

import json
import os
import subprocess
import threading
from dataclasses import dataclass
from typing import IO, Callable, Mapping, cast

OnProgress = Callable[[str, float, str], None]
"""Callback ``on_progress(stage, fraction, message)`` with the fraction of the stage that is done."""

_OF_CURA = (
    "PYTHONHOME",
    "PYTHONPATH",
    "LD_LIBRARY_PATH",
    "DYLD_LIBRARY_PATH",
    "QT_PLUGIN_PATH",
    "QML2_IMPORT_PATH",
)
"""Variables by which a packaged Cura finds its own Python and libraries; they would break another Python."""


@dataclass(frozen=True)
class Ended:
    """How a process ended.

    Attributes
    ----------
    code
        Exit code; None if the program did not start.
    output
        Text of standard output.
    error
        Last line of standard error that is no progress; empty if there is none.
    cancelled
        Whether `Process.cancel` ended it.
    """

    code: int | None
    output: str = ""
    error: str = ""
    cancelled: bool = False


class Process:
    """Runs commands one after another until one is cancelled."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: subprocess.Popen[str] | None = None
        self._cancelled = False

    def run(self, command: list[str], on_progress: OnProgress) -> Ended:
        """Run a command to its end.

        Parameters
        ----------
        command
            Program and arguments.
        on_progress
            Called for each line of progress.
        """
        try:
            process = self._start(command)
        except (OSError, ValueError) as error:
            return Ended(
                None, error=f"{command[0]} does not start: {getattr(error, 'strerror', None) or error}"
            )
        if process is None:
            return Ended(None, cancelled=True)
        with process:  # closes the pipes
            return self._followed(process, on_progress)

    def _followed(self, process: subprocess.Popen[str], on_progress: OnProgress) -> Ended:
        """Read both outputs to their ends; another thread reads one of them, because a full pipe would block amprep."""
        output: list[str] = []
        reader = threading.Thread(
            target=lambda: output.append(cast(IO[str], process.stdout).read()), daemon=True
        )
        reader.start()
        last = ""
        for line in cast(IO[str], process.stderr):
            step = progress_of(line)
            if step is None:
                last = line.strip() or last
            else:
                on_progress(*step)
        code = process.wait()
        reader.join()
        return Ended(code, "".join(output), last, self._cancelled)

    def cancel(self) -> None:
        """End the running command, and start no other; amprep then writes no files."""
        with self._lock:
            self._cancelled = True
            if self._running is not None:
                self._running.terminate()

    def _start(self, command: list[str]) -> subprocess.Popen[str] | None:
        with self._lock:
            if self._cancelled:
                return None
            self._running = subprocess.Popen(  # noqa: S603 - no shell; the program is the user's choice
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                env=environment(os.environ),
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
            return self._running


def progress_of(line: str) -> tuple[str, float, str] | None:
    """Return stage, fraction and message of a line of progress; None if the line is something else."""
    try:
        step = json.loads(line) if line.startswith("{") else None
        return None if step is None else (str(step["stage"]), float(step["fraction"]), str(step["message"]))
    except (ValueError, KeyError, TypeError):
        return None


def environment(own: Mapping[str, str]) -> dict[str, str]:
    """Return the environment for another Python: without the variables of Cura's own, and with UTF-8 output."""
    return {**{key: value for key, value in own.items() if key not in _OF_CURA}, "PYTHONUTF8": "1"}
