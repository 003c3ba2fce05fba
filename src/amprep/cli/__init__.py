"""Command line: parse arguments, print results and set the exit code; nothing is computed here."""

import gc
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import NoReturn

DONE, INCOMPLETE, WRONG, INTERRUPTED = 0, 1, 2, 130
"""Exit codes: done; done, but something is unplaced, unsupported or broken; wrong input or usage; ended by Ctrl-C."""


_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Numbers of settings of malloc in glibc: how much free memory is kept, and the size of what is never kept."""

_KEPT_BYTES = 1 << 30

_OBJECTS_PER_SEARCH = 20_000
"""New objects after which Python searches for unreachable ones among them."""

_SEARCHES_PER_WIDER_SEARCH = 50, 100
"""Searches after which older objects are searched, too, and wider searches after which all are."""


def _say(line: str) -> None:
    sys.stderr.write(f"amprep: {line}\n")


def _end_interrupted(error: BaseException) -> NoReturn:
    """Say that the run was interrupted, and end at once."""
    from amprep import interruption, supervision
    from amprep.errors import Interrupted

    _say(_line_of(error) if isinstance(error, Interrupted) else "interrupted; nothing was written")
    sys.stdout.flush()
    sys.stderr.flush()
    supervision.finish(interruption.exit_code())
    # Python may crash when it unloads compiled libraries that were interrupted
    os._exit(interruption.exit_code())


def _end_at_once(clean: Callable[[], None]) -> None:
    """End the process inside the handler of a signal; where foreign plugins run, the interruption names them."""
    from amprep import interruption, supervision

    if not supervision.is_supervised():
        clean()
        interruption.exit_at_once()


def _line_of(error: BaseException) -> str:
    return " ".join(str(error).split())


def _say_late() -> None:
    """Tell the user that a signal came too late to stop the run."""
    from amprep import interruption

    late = interruption.came_late()
    if late is not None:
        _say(f"{signal.Signals(late).name} came when the files appeared; all of them are complete")


def _set_up() -> None:
    """Set what saves time in this process; imports of libraries come after it."""
    # imports make many objects and no garbage: searching for it as often as usual takes a sixth of the start,
    # and a tenth of the time of compiling kernels
    gc.set_threshold(_OBJECTS_PER_SEARCH, *_SEARCHES_PER_WIDER_SEARCH)
    # products of matrices of 3 x 3 gain nothing from threads, and idle ones take processor time
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _keep_freed_memory()


def _keep_freed_memory() -> None:
    """Let the C library keep what is freed, where it is glibc.

    The system clears each page that it gives out, and solids and arrays of many megabytes come and go all the time.
    """
    if sys.platform == "linux":
        import ctypes

        with suppress(AttributeError, OSError):
            library = ctypes.CDLL(None)
            library.mallopt(_TRIM_THRESHOLD, _KEPT_BYTES)
            library.mallopt(_MMAP_THRESHOLD, _KEPT_BYTES)


def main() -> NoReturn:
    """Run the command line; a mistake of the user is reported in one line with exit code 2, without a traceback."""
    # until `watch`, because imports that are interrupted print tracebacks
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from amprep import interruption, supervision

    try:
        _run()
    except SystemExit as end:
        interruption.end()
        supervision.finish(end.code if isinstance(end.code, int) else int(end.code is not None))
        raise
    except BaseException:
        supervision.finish(INCOMPLETE)  # the code of Python for an error that --debug shows
        raise


def _run() -> NoReturn:
    from amprep import interruption
    from amprep.errors import AmprepError, Interrupted

    debug = "--debug" in sys.argv
    try:
        interruption.watch(_end_at_once)
        _set_up()
        from amprep.cli.app import app

        app()
        sys.exit(DONE)
    except (KeyboardInterrupt, Interrupted) as error:
        _end_interrupted(error)
    except SystemExit as end:
        if (
            end.code == INTERRUPTED and interruption.came_late() is None
        ):  # typer makes this of a KeyboardInterrupt
            _end_interrupted(end)
        _say_late()
        raise
    except AmprepError as error:
        if debug:
            raise
        _say(_line_of(error))
        sys.exit(WRONG)
    except MemoryError:
        if debug:
            raise
        _say("out of memory; use a coarser pitch (--set supports.pitch_mm=2) or fewer parts per run")
        sys.exit(WRONG)
    except Exception as error:
        if debug:
            raise
        _say(
            f"internal error, {type(error).__name__}: {_line_of(error)}; run again with --debug and report it"
        )
        sys.exit(WRONG)
