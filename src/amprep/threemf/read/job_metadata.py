"""Read amprep's own metadata of a part in a 3MF job: quantity, value and rotations."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from amprep.errors import InputError, JobError
from amprep.model.part import Orientations
from amprep.model.rotations import parse_rotations
from amprep.threemf.names import NAMESPACE

MOST_COPIES = 100_000

PartMetadata = Mapping[tuple[str, str], str]
"""(namespace, name) -> value."""


class JobMetadata(NamedTuple):
    """Settings of a part that a 3MF job states as metadata."""

    quantity: int = 1
    value: float | None = None
    orientations: Orientations = Orientations()


def parse_job_metadata(metadata: PartMetadata, where: str) -> JobMetadata:
    """Return the settings that the metadata ``quantity``, ``value`` and ``rotations`` state.

    Parameters
    ----------
    where
        File and part, for messages.

    Raises
    ------
    InputError
        For an invalid value.
    """
    quantity = metadata.get((NAMESPACE, "quantity"), "1")
    value = metadata.get((NAMESPACE, "value"))
    try:
        orientations = parse_rotations(metadata.get((NAMESPACE, "rotations"), "none"))
    except JobError as error:
        raise InputError(f"{where}: {error}") from error
    return JobMetadata(
        _quantity(quantity, where), None if value is None else _value(value, where), orientations
    )


def foreign_metadata(metadata: PartMetadata) -> dict[tuple[str, str], str]:
    """Return the metadata of other programs; amprep's own describes the job, not the part."""
    return {key: value for key, value in metadata.items() if key[0] != NAMESPACE}


def _quantity(text: str, where: str) -> int:
    digits = text.strip()
    if not (digits.isascii() and digits.isdigit() and len(digits) < 10 and 1 <= int(digits) <= MOST_COPIES):
        raise InputError(f"{where}: expected a quantity from 1 to {MOST_COPIES}, got {text[:40]!r}")
    return int(digits)


def _value(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise InputError(f"{where}: expected a value of at least 0, got {text[:40]!r}")
    return value
