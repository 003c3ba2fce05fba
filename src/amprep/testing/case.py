"""One sample problem for one offer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from amprep.checks.violation import Violation
from amprep.model import Stop


@dataclass(frozen=True)
class Case:
    """One sample problem for one offer.

    Attributes
    ----------
    problem
        Title of the problem.
    run
        Calls the offer with a stop and returns its answer.
    judge
        Returns the promises that the answer breaks.
    timed
        Whether the offer is also run with no time left, and must then keep its promises too.
    """

    problem: str
    run: Callable[[Stop], Any]
    judge: Callable[[Any], Sequence[Violation]]
    timed: bool = True
