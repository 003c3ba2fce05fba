"""Watch over calls of foreign plugins from a second process, which sees what the first one cannot.

A plugin may end its process, crash it, or run on for ever. Strategy: before any plugin is loaded, the process forks.
The child does the work. It writes on a shared board which plugin it calls, until when that has to return, and its exit
code. The parent passes signals on, waits, and reports what is missing on the board. Without foreign plugins nothing is
forked. Where `os.fork` does not exist, nothing is supervised.
"""

import mmap
import os
import select
import signal
import struct
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from amprep import interruption
from amprep.files import remove_abandoned

ENABLED = True
"""Tests that run the command line within their own process switch it off."""

GRACE_S = 10.0
"""A plugin has this much time after its deadline, and after a signal, before its process is ended."""

_POLL_S = 0.1
_SIZE = 4096
_HEAD = struct.Struct("=?i?dH")
"""Whether the exit code is known, the code, whether files appeared, the deadline, and the length of the title."""

WRONG, INCOMPLETE = 2, 1


class _Board:
    """Memory that parent and child share; the child writes, the parent reads."""

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, _SIZE)
        self.title, self.deadline = "", float("inf")
        self.code: int | None = None
        self.appeared = False

    def write(self) -> None:
        """Publish the attributes."""
        text = self.title.encode("utf-8", "replace")[: _SIZE - _HEAD.size]
        self._memory[_HEAD.size : _HEAD.size + len(text)] = text
        head = (self.code is not None, self.code or 0, self.appeared, self.deadline, len(text))
        self._memory[: _HEAD.size] = _HEAD.pack(*head)

    def read(self) -> None:
        """Set the attributes to what the other process wrote."""
        known, code, self.appeared, self.deadline, length = _HEAD.unpack(self._memory[: _HEAD.size])
        self.title = self._memory[_HEAD.size : _HEAD.size + length].decode("utf-8", "replace")
        self.code = code if known else None


@dataclass
class _Supervised:
    board: _Board | None = None
    limit_s: float | None = None


_STATE = _Supervised()


def supervise(folder: Path | None = None, limit_s: float | None = None) -> None:
    """Continue in a child process whose end this process reports.

    Parameters
    ----------
    folder
        Output folder, from which the hidden folder of a child is removed that had to be ended.
    limit_s
        Seconds that a call may take which has no deadline of its own; None for no limit.
    """
    if not (ENABLED and hasattr(os, "fork")) or _STATE.board is not None:
        return
    board = _Board()
    board.write()
    alive, held_by_child = os.pipe()
    sys.stdout.flush()
    sys.stderr.flush()
    parent = os.getpid()
    child = os.fork()
    if child:
        os.close(held_by_child)
        _Parent(child, board, alive, folder).wait()
    os.close(alive)
    interruption.end_with(parent, WRONG)
    _STATE.board, _STATE.limit_s = board, limit_s
    interruption.tell_when_files_appear(_files_appeared)


@contextmanager
def calling(title: str, deadline: float | None = None) -> Iterator[None]:
    """Name the plugin that is called in the block, and the value of ``time.monotonic()`` at which it has to return."""
    board = _STATE.board
    if board is None:
        yield
        return
    if deadline is None and _STATE.limit_s is not None:
        deadline = time.monotonic() + _STATE.limit_s
    before = board.title, board.deadline
    board.title, board.deadline = title, float("inf") if deadline is None else deadline
    board.write()
    try:
        yield
    finally:
        board.title, board.deadline = before
        board.write()


def is_supervised() -> bool:
    """Tell whether another process watches over this one."""
    return _STATE.board is not None


def finish(code: int) -> None:
    """Tell the parent the exit code: from now on, an end of this process is no fault of a plugin."""
    if _STATE.board is not None:
        _STATE.board.code, _STATE.board.title = code, ""
        _STATE.board.write()


def _files_appeared() -> None:
    if _STATE.board is not None:
        _STATE.board.appeared = True
        _STATE.board.write()


class _Parent:
    """The process that the user started: waits for its child and exits as the child did, or says what went wrong."""

    def __init__(self, child: int, board: _Board, alive: int, folder: Path | None) -> None:
        self.child, self.board, self.alive, self.folder = child, board, alive, folder
        self.signalled: int | None = None
        self.ended_by = float("inf")

    def wait(self) -> NoReturn:
        for number in interruption.SIGNALS:
            signal.signal(number, self._pass_on)
        while True:
            ended, status = os.waitpid(self.child, os.WNOHANG)
            if ended:
                self._exit_as(status)
            self.board.read()
            if self.board.title:
                self._end_if_overdue(self.board.title)
            select.select([self.alive], [], [], _POLL_S)
            time.sleep(0.001)

    def _pass_on(self, number: int, _frame: object) -> None:
        if self.signalled is None:
            self.signalled, self.ended_by = number, time.monotonic() + GRACE_S / 2
        with suppress(ProcessLookupError):
            os.kill(self.child, number)

    def _end_if_overdue(self, title: str) -> None:
        """End the child if a plugin does not return, which cannot be while files appear."""
        now = time.monotonic()
        if now > self.ended_by:
            self._kill()
            self._say(f"interrupted while {title} ran; nothing was written")
            os._exit(128 + (self.signalled or signal.SIGINT))
        if now > self.board.deadline + GRACE_S:
            self._kill()
            self._say(
                f"{title} did not return within {GRACE_S:g} s after its time limit; nothing was written"
            )
            os._exit(WRONG)

    def _exit_as(self, status: int) -> NoReturn:
        self.board.read()
        code, board = os.waitstatus_to_exitcode(status), self.board
        if board.code is not None:
            os._exit(board.code)
        if self.signalled is not None and code == 128 + self.signalled:
            os._exit(code)  # the second signal, which the child itself reported
        self._remove_folders()
        if board.appeared:
            self._say("a plugin ended the process when the files had appeared; all of them are complete")
            os._exit(INCOMPLETE)
        if self.signalled is not None:  # an exception that crosses compiled libraries may crash them
            self._say("interrupted; nothing was written")
            os._exit(128 + self.signalled)
        if code >= 0:
            self._say(f"{board.title or 'a plugin'} ended the process; nothing was written")
        else:
            during = f" while {board.title} ran" if board.title else ""
            self._say(f"the process crashed ({signal.Signals(-code).name}){during}; nothing was written")
        os._exit(WRONG)

    def _kill(self) -> None:
        os.kill(self.child, signal.SIGKILL)
        os.waitpid(self.child, 0)
        self._remove_folders()

    def _remove_folders(self) -> None:
        for each in (self.folder, self.folder and self.folder.parent):
            with suppress(OSError):
                if each is not None and each.is_dir():
                    remove_abandoned(each)

    @staticmethod
    def _say(line: str) -> None:
        sys.stderr.write(f"amprep: {line}\n")
        sys.stderr.flush()
