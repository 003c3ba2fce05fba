"""Parameters of the built-in packers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ExtremePointsParams:
    """Parameters of `extreme-points`; all of them count work, so that the same job gives the same packing.

    Attributes
    ----------
    sortings
        At most so many passes are made, each with an order and a way to choose places; 0: as many as suit the
        room, which is 12 for fewest builds of boxes that may be stacked, else all there are.
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


@dataclass(frozen=True)
class TabuParams:
    """Parameters of `tabu`; the budget counts work, so that the same job gives the same packing.

    Attributes
    ----------
    start
        ``separate``: every item in a build of its own, as in the thesis; ``heuristic``: as the sub-heuristic
        packs them all.
    most_tuple
        Builds repacked at once, at most (the thesis's k_max).
    most_diversify
        Diversifications before a strong one (the thesis's d_max).
    tenure
        How many of the last penalties are tabu, for each size of tuple.
    count_weight
        Weight of the share of items in the filling function, which is the share of volume less this much of
        the share of items; 0 as in the thesis, where it only breaks ties.
    patience
        Strong diversifications without a better packing after which the search ends.
    work
        Millions of comparisons of boxes after which the search ends; some 200 a second.
    """

    start: str = "separate"
    most_tuple: int = 3
    most_diversify: int = 3
    tenure: int = 3
    count_weight: float = 0.0
    patience: int = 3
    work: float = 100.0

    def __post_init__(self) -> None:
        if self.start not in {"separate", "heuristic"}:
            raise ValueError(f"start must be separate or heuristic, got {self.start!r}")
        _at_least("most_tuple", self.most_tuple, 1)
        _at_least("most_diversify", self.most_diversify, 0)
        _at_least("tenure", self.tenure, 0)
        _at_least("count_weight", self.count_weight, 0)
        _at_least("patience", self.patience, 0)
        _at_least("work", self.work, 0)


@dataclass(frozen=True)
class AutoParams:
    """Parameters of `auto`; the budgets count work, so that the same job gives the same packing.

    Attributes
    ----------
    most_ruined
        Builds that one step packs anew, at most.
    heat
        How much worse a step may be: mean of the excess, in items of mean volume.
    patience
        Steps for each item after which a smaller number of builds is given up; in a fill problem, so many
        disturbed orders.
    work
        Millions of comparisons after which the search ends; some 40 a second.
    proof
        Millions of comparisons spent on the bound, in a second thread; some 170 a second.
    """

    most_ruined: int = 3
    heat: float = 0.05
    patience: int = 1000
    work: float = 100.0
    proof: float = 400.0

    def __post_init__(self) -> None:
        _at_least("most_ruined", self.most_ruined, 1)
        _at_least("heat", self.heat, 0)
        _at_least("patience", self.patience, 0)
        _at_least("work", self.work, 0)
        _at_least("proof", self.proof, 0)


@dataclass(frozen=True)
class SweepParams:
    """Parameters of `sweep`.

    Attributes
    ----------
    slicings
        At most so many of the choices of axes and orders are tried (0: all).
    """

    slicings: int = 0

    def __post_init__(self) -> None:
        _at_least("slicings", self.slicings, 0)


@dataclass(frozen=True)
class BlockBuildingParams:
    """Parameters of `block-building`; the budget counts work, so that the same job gives the same packing.

    Attributes
    ----------
    blocks
        Blocks that each of the two searches builds, at most; there is always one for each single box.
    work
        Millions of blocks and spaces looked at after which the searches end; some 200 a second.
    """

    blocks: int = 10_000
    work: float = 500.0

    def __post_init__(self) -> None:
        _at_least("blocks", self.blocks, 0)
        _at_least("work", self.work, 0)
