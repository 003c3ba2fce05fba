"""Check bounds of settings and read TOML files within limits; one style of message: rule, value, what to do."""

import tomllib
from pathlib import Path
from typing import Any

from amprep.errors import JobError

LARGEST_FILE = 4 * 1024 * 1024
"""Largest job or printer file (bytes); such files are written by hand."""


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
            raise JobError(f"{path}: a {what} file must have at most {LARGEST_FILE >> 20} MiB")
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise JobError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        reason = "lists or tables nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise JobError(f"{path}: not a TOML file ({reason})") from error


def require(holds: bool, rule: str, value: object, advice: str = "") -> None:
    """Raise `ValueError` unless the rule holds: ``RULE, got VALUE``, followed by the advice.

    Parameters
    ----------
    holds
        Whether the value satisfies the rule.
    rule
        The rule as a sentence without a full stop, for example ``count must be at least 1``.
    value
        The value that was given.
    advice
        The remedy, if the rule alone does not say it.
    """
    if not holds:
        raise ValueError(f"{rule}, got {value}" + (f"; {advice}" if advice else ""))


def require_bounds(
    record: object,
    *names: str,
    at_least: float | None = None,
    above: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
) -> None:
    """Check that numeric fields of a record are within bounds; a field that is None is not checked.

    Parameters
    ----------
    record
        Object whose attributes are checked, usually ``self`` in ``__post_init__``.
    names
        Names of the attributes; the same bounds apply to each.
    at_least, above
        Lower bound, included or excluded; None for no lower bound.
    at_most, below
        Upper bound, included or excluded; None for no upper bound.

    Raises
    ------
    ValueError
        For the first attribute outside the bounds or not a number, with the rule and the value.

    Examples
    --------
    >>> class Box:
    ...     width_mm = -1.0
    >>> require_bounds(Box(), "width_mm", above=0)
    Traceback (most recent call last):
    ValueError: width_mm must be above 0, got -1.0
    """
    for name in names:
        value = getattr(record, name)
        within = value is None or (
            (at_least is None or value >= at_least)
            and (above is None or value > above)
            and (at_most is None or value <= at_most)
            and (below is None or value < below)
            and value == value  # noqa: PLR0124 - false for NaN only
        )
        require(within, f"{name} must be {_bounds(at_least, above, at_most, below)}", value)


def _bounds(at_least: float | None, above: float | None, at_most: float | None, below: float | None) -> str:
    if at_least is not None and at_most is not None:
        return f"between {at_least} and {at_most}"
    named = (("at least", at_least), ("above", above), ("at most", at_most), ("below", below))
    return " and ".join(f"{word} {bound}" for word, bound in named if bound is not None)


LARGEST_COUNT = 1_000_000
"""Bound on quantities, capacities and costs: sums of them stay far inside 64 bits."""

LARGEST_LENGTH = 10_000.0
"""Bound on distances and sizes (mm) that jobs and build files state; no printer is larger."""

LARGEST_COORDINATE = 1e6
"""Bound on coordinates (mm) in the record of a build file; parts may lie anywhere in coordinates of their own."""

LEAST_REACH = 0.05
"""Least reach, mm: overhangs are sampled a third of it apart."""

LARGEST_OVERLAP = 5.0
"""Largest depth (mm) to which connectors may enter parts."""
