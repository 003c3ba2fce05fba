"""Read the values of slicers' profiles."""

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError

LARGEST_FILE = 64_000_000
"""Bytes; the largest bundle of PrusaSlicer has 1 million."""

MOST_PARENTS = 30
"""Longest chain of profiles that inherit from one another."""


def outline_of(text: str, name: str) -> Floats:
    """Return the corners ``(n, 2)`` that a text such as ``0x0,250x0,250x210,0x210`` lists.

    Raises
    ------
    InputError
        If it is not such a text.
    """
    try:
        corners = [[float(value) for value in corner.strip().split("x")] for corner in text.split(",")]
        return np.array(corners, np.float64).reshape(-1, 2)
    except ValueError as error:
        raise InputError(
            f"{name}: expected corners such as 0x0,250x0,250x210, found {text[:60]!r}"
        ) from error


def number_of(value: object, name: str, what: str) -> float:
    """Return a number; a list counts as its first value.

    Raises
    ------
    InputError
        If it is no number.
    """
    if isinstance(value, list) and value:
        value = value[0]
    try:
        return float(str(value))
    except ValueError as error:
        raise InputError(f"{name}: expected a number for the {what}, found {str(value)[:40]!r}") from error
