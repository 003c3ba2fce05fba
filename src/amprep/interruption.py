"""Signals that end a run: all files of a run appear, or none.

A signal belongs to the process, hence so does the state of this module. The command line calls `watch`; a program that
uses the API keeps its own handlers, which then wait while files appear.
"""

import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from types import FrameType
from typing import NoReturn

SIGNALS = tuple(getattr(signal, name) for name in ("SIGHUP", "SIGTERM", "SIGINT") if hasattr(signal, name))

REPEATED_AFTER_S = 0.5
"""A terminal and a supervisor may send the same signal at once; a later one is sent again by the user."""


@dataclass
class _SignalState:
    watching: bool = False
    received: int | None = None
    received_at: float = 0.0
    appeared: bool = False
    tell: Callable[[], None] | None = None
    late: int | None = None
    ending: bool = False
    end_at_once: Callable[[Callable[[], None]], None] | None = None
    clean: Callable[[], None] | None = None


_STATE = _SignalState()

_OTHER_HOOKS: "list[Callable[[sys.UnraisableHookArgs], object]]" = []
"""What told of exceptions that cannot be raised before `watch`; the last one counts."""


def watch(end_at_once: Callable[[Callable[[], None]], None] | None = None) -> None:
    """End the run at a signal until its files appear; note a signal that comes later.

    The first signal raises `KeyboardInterrupt`. Another one after `REPEATED_AFTER_S` ends the process at once, because
    the code that runs may catch every exception.

    Parameters
    ----------
    end_at_once
        Called at the first signal with the function that `clean_with` named, which it calls before it ends the process;
        it returns if `KeyboardInterrupt` is to be raised. An exception that crosses compiled libraries may crash them.
    """
    _STATE.__dict__.update(vars(_SignalState(watching=True, end_at_once=end_at_once)))
    if sys.unraisablehook is not _tell_unraisable:
        _OTHER_HOOKS.append(sys.unraisablehook)
        sys.unraisablehook = _tell_unraisable
    for number in SIGNALS:
        signal.signal(number, _handle)


def _tell_unraisable(lost: "sys.UnraisableHookArgs") -> None:
    """Tell of an exception that cannot be raised, unless it is that of a signal, which `raise_lost` raises again."""
    if received() is None or not issubclass(lost.exc_type, KeyboardInterrupt):
        _OTHER_HOOKS[-1](lost)


def raise_lost() -> None:
    """Raise `KeyboardInterrupt` if a signal came whose exception Python dropped, as it does in callbacks of imports."""
    if _STATE.watching and _STATE.received is not None and not (_STATE.appeared or _STATE.ending):
        raise KeyboardInterrupt


def end() -> None:
    """Ignore signals from now on: the result is known, and the process ends."""
    _STATE.ending = True
    atexit.register(_ignore_signals)


def _ignore_signals() -> None:
    """Keep signals from ending the process by their default actions, which Python restores when it unloads itself."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def received() -> int | None:
    """Return the signal that ends the run, or None."""
    return _STATE.received


def came_late() -> int | None:
    """Return the signal that came when files had appeared, or None."""
    return _STATE.late


def is_raised_by_code() -> bool:
    """Tell whether a `KeyboardInterrupt` that was caught comes from code, since no signal came."""
    return _STATE.watching and received() is None


def exit_code() -> int:
    """Return the exit code of a run that a signal ended: 128 and the number of the signal, 130 for Ctrl-C."""
    return 128 + (_STATE.received or signal.SIGINT)


def files_appeared() -> None:
    """Note that all files of the run are in place; from now on a signal changes nothing of the result."""
    _STATE.appeared = True
    if _STATE.tell is not None:
        _STATE.tell()


def tell_when_files_appear(tell: Callable[[], None]) -> None:
    """Let `files_appeared` call a function."""
    _STATE.tell = tell


def clean_with(clean: Callable[[], None] | None) -> None:
    """Let a signal that ends the process at once call a function first; None ends that."""
    _STATE.clean = clean


@contextmanager
def held() -> Iterator[None]:
    """Let signals wait until the block ends; then the handlers that were set before get them."""
    if threading.current_thread() is not threading.main_thread():
        yield  # other threads get no signals
        return
    came: list[int] = []
    before = {number: signal.getsignal(number) for number in SIGNALS}
    try:
        for number in SIGNALS:
            signal.signal(number, lambda number, _: came.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        for number in dict.fromkeys(came):
            signal.raise_signal(number)


def end_with(parent: int, code: int) -> None:
    """Let the system kill this process when its parent is killed, which only Linux can do.

    Parameters
    ----------
    parent
        Process that started this one; if it has ended meanwhile, this one ends with an exit code.
    code
        That exit code.
    """
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(code)


def exit_at_once() -> NoReturn:
    """Say that nothing was written and end the process; buffers of Python are not used, since they may be in use."""
    with suppress(OSError, ValueError):
        error = sys.__stderr__.fileno() if sys.__stderr__ else 2
        shown = b"\x1b[?25h\r" if os.isatty(error) else b""  # a bar of progress hides the cursor
        os.write(error, shown + b"amprep: interrupted; nothing was written\n")
    os._exit(exit_code())


def _handle(number: int, _frame: FrameType | None) -> None:
    if _STATE.ending:
        return
    if _STATE.appeared:
        _STATE.late = number
        signal.signal(
            number, signal.SIG_DFL
        )  # a second one ends the process although its table is not printed
        return
    if _STATE.received is None:
        _STATE.received, _STATE.received_at = number, time.monotonic()
        if _STATE.end_at_once is not None and _STATE.clean is not None:
            _STATE.end_at_once(_STATE.clean)
        raise KeyboardInterrupt
    if time.monotonic() - _STATE.received_at >= REPEATED_AFTER_S:
        exit_at_once()
