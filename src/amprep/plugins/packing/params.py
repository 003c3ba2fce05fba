"""Parameters of the built-in packers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ExtremePointsParams:
    """Parameters of `extreme-points`; all of them count work, so that the same job gives the same packing.

    Attributes
    ----------
    sortings
        At most so many of the sortings are tried (0: all).
    restarts
        Further passes over randomly disturbed copies of the best order.
    disturbance
        How far a restart moves an item in the order: share of the number of items.
    work
        Millions of comparisons of boxes and points after which no further pass is begun; some 200 a second.
    """

    sortings: int = 0
    restarts: int = 0
    disturbance: float = 0.1
    work: float = 200.0

    def __post_init__(self) -> None:
        _at_least("sortings", self.sortings, 0)
        _at_least("restarts", self.restarts, 0)
        _at_least("work", self.work, 0)
        if not 0.0 < self.disturbance <= 1.0:
            raise ValueError(f"disturbance must be above 0 and at most 1, got {self.disturbance}")


def _at_least(name: str, value: float, least: float) -> None:
    if not value >= least:
        raise ValueError(f"{name} must be at least {least}, got {value}")
