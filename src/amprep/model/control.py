"""Deadline, cancellation and progress, which every long function takes as arguments."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from threading import Event

Progress = Callable[[float, str], None]
"""Callback ``progress(fraction, message)`` with the fraction that is done, in [0, 1]; it must be fast."""


def silent(fraction: float, message: str) -> None:
    """Ignore the progress."""


@dataclass(frozen=True, eq=False)
class Stop:
    """Tells a long computation to end and return its best answer so far.

    Attributes
    ----------
    deadline
        Value of ``time.monotonic()`` at which to stop; None for no deadline.
    cancelled
        Event that is set when the user interrupts.
    """

    deadline: float | None = None
    cancelled: Event = field(default_factory=Event)

    @classmethod
    def after(cls, seconds: float | None) -> "Stop":
        """Return a stop that becomes true after `seconds`; None for never."""
        return cls(None if seconds is None else time.monotonic() + seconds)

    def __call__(self) -> bool:
        """Tell whether to stop now."""
        return self.cancelled.is_set() or self.remaining() <= 0.0

    def remaining(self) -> float:
        """Return the seconds that are left, ``inf`` without a deadline."""
        return float("inf") if self.deadline is None else self.deadline - time.monotonic()

    def within(self, seconds: float | None) -> "Stop":
        """Return a stop with the same cancellation and the earlier of this deadline and `seconds` from now."""
        if seconds is None:
            return self
        deadline = time.monotonic() + seconds
        return Stop(deadline if self.deadline is None else min(deadline, self.deadline), self.cancelled)

    @property
    def reason(self) -> str:
        """``interrupted`` or ``time limit``: the reason to stop, once the stop is true."""
        return "interrupted" if self.cancelled.is_set() else "time limit"
