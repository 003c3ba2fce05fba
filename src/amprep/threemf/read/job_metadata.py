"""What a 3MF job says of a part in amprep's namespace: quantity, value and rotations."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from amprep.errors import InputError, JobError
from amprep.model.part import Orientations
from amprep.model.rotations import parse_rotations
from amprep.threemf.build.record import NAMESPACE

MOST_COPIES = 100_000

Metadata = Mapping[tuple[str, str], str]


class Wishes(NamedTuple):
    """What the job wants of a part."""

    quantity: int = 1
    value: float | None = None
    orientations: Orientations = Orientations()


def wishes_of(metadata: Metadata, where: str) -> Wishes:
    """Return what the metadata ``quantity``, ``value`` and ``rotations`` ask for.

    Raises
    ------
    InputError
        For a value that cannot be meant; `where` names file and part.
    """
    quantity = metadata.get((NAMESPACE, "quantity"), "1")
    value = metadata.get((NAMESPACE, "value"))
    try:
        orientations = parse_rotations(metadata.get((NAMESPACE, "rotations"), "none"))
    except JobError as error:
        raise InputError(f"{where}: {error}") from error
    return Wishes(_quantity(quantity, where), None if value is None else _value(value, where), orientations)


def foreign(metadata: Metadata) -> dict[tuple[str, str], str]:
    """Return the metadata that is not amprep's own: that speaks of a job or build, not of the part."""
    return {key: value for key, value in metadata.items() if key[0] != NAMESPACE}


def _quantity(text: str, where: str) -> int:
    plain = text.strip()
    if not (plain.isascii() and plain.isdigit() and len(plain) < 10 and 1 <= int(plain) <= MOST_COPIES):
        raise InputError(f"{where}: expected a quantity from 1 to {MOST_COPIES}, got {text[:40]!r}")
    return int(plain)


def _value(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise InputError(f"{where}: expected a value of 0 or more, got {text[:40]!r}")
    return value
