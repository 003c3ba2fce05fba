"""Reads a TOML file into a table, within limits, and says in one line what is wrong with it."""

import tomllib
from pathlib import Path
from typing import Any

from amprep.errors import JobError

LARGEST_FILE = 4 * 1024 * 1024
"""bytes; a job or printer file is written by hand."""


def read_table(path: Path, what: str) -> dict[str, Any]:
    """Return the table of the TOML file at `path`; `what` names the kind of file in messages.

    Raises
    ------
    JobError
        When the file cannot be read, is too large, or is not TOML.
    """
    if not path.is_file():
        raise JobError(
            f"{path}: expected a {what} file, {'got a folder' if path.is_dir() else 'found nothing'}"
        )
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise JobError(f"{path}: a {what} file may have {LARGEST_FILE} bytes, this one has more")
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise JobError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        reason = "lists or tables nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise JobError(f"{path}: not a TOML file ({reason})") from error


def require(holds: bool, rule: str, value: object) -> None:
    """Raise `ValueError` with the rule and the value that breaks it."""
    if not holds:
        raise ValueError(f"{rule}, got {value}")


LARGEST_COUNT = 1_000_000
"""Bound on quantities, capacities and costs: sums of them stay far inside 64 bits."""
