"""What a broken promise looks like."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Violation:
    """One broken promise.

    Attributes
    ----------
    promise
        Short name, the same for every violation of the promise: ``inside build volume``, ``clearance``, ...
    subject
        What broke it: a part's label, a support's name.
    message
        Expected, found, with numbers and units.
    """

    promise: str
    subject: str
    message: str
