"""Deadline, cancellation and progress, handed as arguments to everything long."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from threading import Event

Progress = Callable[[float, str], None]
"""Called with the share done in [0, 1] and a few words; must be cheap."""


def silent(share: float, words: str) -> None:
    """Report to nobody."""


@dataclass(frozen=True, eq=False)
class Stop:
    """Tells a long computation to end now and give its best answer so far.

    Attributes
    ----------
    deadline
        Value of ``time.monotonic()`` after which to stop; None for none.
    cancelled
        Set when the user interrupts.
    """

    deadline: float | None = None
    cancelled: Event = field(default_factory=Event)

    @classmethod
    def after(cls, seconds: float | None) -> "Stop":
        """Stop once `seconds` from now have passed; None never stops."""
        return cls(None if seconds is None else time.monotonic() + seconds)

    def __call__(self) -> bool:
        """Whether to stop now."""
        return self.cancelled.is_set() or self.remaining() <= 0.0

    def remaining(self) -> float:
        """Seconds left, ``inf`` without a deadline."""
        return float("inf") if self.deadline is None else self.deadline - time.monotonic()

    def within(self, seconds: float | None) -> "Stop":
        """Return a stop that shares the cancellation and ends after `seconds`, or with this one if earlier."""
        if seconds is None:
            return self
        deadline = time.monotonic() + seconds
        return Stop(deadline if self.deadline is None else min(deadline, self.deadline), self.cancelled)

    @property
    def reason(self) -> str:
        """``interrupted`` or ``time limit``; only meaningful once the call says True."""
        return "interrupted" if self.cancelled.is_set() else "time limit"
