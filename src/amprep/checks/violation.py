"""The record of a broken promise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats


@dataclass(frozen=True)
class Violation:
    """One broken promise.

    Attributes
    ----------
    promise
        Short name of the promise, such as ``inside build volume`` or ``clearance``.
    subject
        The part, support or item that breaks it.
    message
        The finding and the expectation, with numbers and units.
    """

    promise: str
    subject: str
    message: str

    def __str__(self) -> str:
        """Return the violation in one line."""
        return f"{self.promise}: {self.subject}: {self.message}"


def place_words(point: Floats | Sequence[float], digits: int = 2) -> str:
    """Return the coordinates of a point as all messages and reports state them: ``(12.5, -3, 0.04)``."""
    return f"({', '.join(f'{round(value, digits) + 0.0:.9g}' for value in np.asarray(point).tolist())})"
