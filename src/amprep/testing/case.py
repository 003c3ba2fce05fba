"""One problem for one offer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from amprep.checks.violation import Violation
from amprep.model import Stop

SEED = 20


@dataclass(frozen=True)
class Case:
    """One tiny problem for one offer.

    Attributes
    ----------
    run
        Calls the offer, given when to stop, and returns its answer.
    judge
        Returns the promises that the answer breaks.
    timed
        Whether it is also run with no time left, which must not break a promise either.
    """

    problem: str
    run: Callable[[Stop], Any]
    judge: Callable[[Any], Sequence[Violation]]
    timed: bool = True
