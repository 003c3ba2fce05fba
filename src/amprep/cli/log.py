"""The log of a run: what was done, and when, one line each."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

Log = Callable[[str], None]


@contextmanager
def logging_to(path: Path | None) -> Iterator[Log]:
    """Yield a function that appends a line to a file, or does nothing if there is none.

    The log begins with version, command and folder, and ends with the duration and what ended the run.

    Raises
    ------
    AmprepError
        If the file cannot be written.
    """
    from amprep import __version__
    from amprep.errors import AmprepError

    if path is None:
        yield lambda _: None
        return
    begin = time.monotonic()
    try:
        stream = path.open("a", encoding="utf-8")
    except OSError as error:
        raise AmprepError(f"cannot write the log {path}: {error.strerror or error}") from error
    with stream:

        def log(line: str) -> None:
            now = datetime.now().astimezone().isoformat(timespec="milliseconds")
            stream.write(f"{now} {' '.join(line.split())}\n")
            stream.flush()

        log(f"amprep {__version__} in {Path.cwd()}: {' '.join(sys.argv[1:])}")
        try:
            yield log
        except BaseException as error:
            log(f"ended after {time.monotonic() - begin:.1f} s by {type(error).__name__}: {error}")
            raise
        log(f"finished after {time.monotonic() - begin:.1f} s")
