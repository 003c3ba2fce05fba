"""Command line: parse arguments, print results and set the exit code; nothing is computed here."""

import os
import signal
import sys
from typing import NoReturn

from amprep.errors import AmprepError, Interrupted

DONE, INCOMPLETE, WRONG, INTERRUPTED = 0, 1, 2, 130
"""Exit codes: done; done, but something is unplaced, unsupported or broken; wrong input or usage; interrupted."""


def _say(line: str) -> None:
    sys.stderr.write(f"amprep: {line}\n")


def _end_interrupted() -> NoReturn:
    """Say that the run was interrupted, and end at once."""
    _say("interrupted; nothing was written")
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(INTERRUPTED)  # Python may crash when it unloads compiled libraries that were interrupted


def main() -> NoReturn:
    """Run the command line; a mistake of the user is reported in one line with exit code 2, without a traceback."""
    debug = "--debug" in sys.argv
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends a run in the same way as Ctrl-C
    try:
        from amprep.cli.app import app

        app()
        sys.exit(DONE)
    except (KeyboardInterrupt, Interrupted):
        _end_interrupted()
    except SystemExit as end:
        if end.code == INTERRUPTED:  # typer makes this of a KeyboardInterrupt
            _end_interrupted()
        raise
    except AmprepError as error:
        if debug:
            raise
        _say(" ".join(str(error).split()))
        sys.exit(WRONG)
    except MemoryError:
        if debug:
            raise
        _say("out of memory; use a coarser pitch (--set supports.pitch_mm=2) or fewer parts per run")
        sys.exit(WRONG)
    except Exception as error:
        if debug:
            raise
        _say(f"internal error, {type(error).__name__}: {error}; run again with --debug and report it")
        sys.exit(WRONG)
