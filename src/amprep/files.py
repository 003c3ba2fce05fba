"""Atomic file writing."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from amprep.errors import AmprepError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` at the end, or delete it after an exception.

    Raises
    ------
    AmprepError
        If the folder or the file cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise AmprepError(f"cannot write {path}: {error.strerror or error}; choose another folder") from error
    finally:
        temporary.unlink(missing_ok=True)
