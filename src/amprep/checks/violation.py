"""The record of a broken promise."""

from dataclasses import dataclass


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
