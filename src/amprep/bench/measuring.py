"""Measure what a computation takes."""

import time
from collections.abc import Callable
from typing import NamedTuple, TypeVar

from amprep.bench.memory import peak_mb, reset_peak

Result = TypeVar("Result")


class Spent(NamedTuple):
    """What a computation took.

    Attributes
    ----------
    seconds, process_seconds
        Time on the clock and of all threads.
    memory_mb
        Peak memory of the process meanwhile, MiB; None where the system does not tell.
    """

    seconds: float
    process_seconds: float
    memory_mb: int | None


def measured(compute: Callable[[], Result]) -> tuple[Result, Spent]:
    """Return the result of a computation, and what it took."""
    reset_peak()
    start, process = time.monotonic(), time.process_time()
    result = compute()
    seconds, process_seconds = time.monotonic() - start, time.process_time() - process
    return result, Spent(seconds, process_seconds, peak_mb())
