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


@dataclass(frozen=True)
class IpParams:
    """Parameters of `ip`.

    Attributes
    ----------
    solver
        pulp's name of the solver. Only HiGHS heeds `effort`, `threads` and `seed`, takes the heuristic's
        packing as a start and tells its bound; any other one ends at the time limit alone.
    effort
        Millions of branch-and-bound nodes times direction variables after which the solver is stopped.
    directions
        A model with more direction variables is not built; the heuristic's packing is the answer then.
    sharing
        The alternative copies of an item, one per orientation, share one position and one set of directions;
        off: each copy has its own (thesis 2.2).
    symmetry
        Equal items, builds and mirror images are put in one order.
    tighten
        Each big-M is the least one for its pair, directions without room are left out, no two opposite
        directions hold, and what is in a build does not exceed its volume; off: as in the thesis.
    threads
        Of the solver; with more than one the answer may differ from run to run.
    seed
        Of the solver.
    """

    solver: str = "HiGHS"
    effort: float = 0.05
    directions: int = 20_000
    sharing: bool = True
    symmetry: bool = True
    tighten: bool = True
    threads: int = 1
    seed: int = 0

    def __post_init__(self) -> None:
        _at_least("effort", self.effort, 0)
        _at_least("directions", self.directions, 0)
        _at_least("threads", self.threads, 1)
        _at_least("seed", self.seed, 0)


@dataclass(frozen=True)
class IpLocalSearchParams(IpParams):
    """Parameters of `ip-local-search`; those of `ip` hold for the programs of the neighbourhoods.

    Symmetry is not broken by default: putting equal items in order would count as distance.

    Attributes
    ----------
    used_distance
        At most so many items enter or leave in one step (thesis 2.2, `used_d` of chapter 4).
    direction_distance
        At most so many directions between pairs that stay change in one step (`dir_d`).
    growth
        Where nothing better is found both distances grow by this factor, at 1 the search ends.
    steps
        At most so many programs are solved.
    """

    symmetry: bool = False
    used_distance: int = 5
    direction_distance: int = 20
    growth: float = 1.5
    steps: int = 10

    def __post_init__(self) -> None:
        super().__post_init__()
        _at_least("used_distance", self.used_distance, 1)
        _at_least("direction_distance", self.direction_distance, 0)
        _at_least("growth", self.growth, 1)
        _at_least("steps", self.steps, 1)


@dataclass(frozen=True)
class ColumnGenerationParams(IpParams):
    """Parameters of `column-generation`; those of `ip` hold for each pricing program and for the cover.

    Attributes
    ----------
    rounds
        At most so many times the cover is solved and builds are priced.
    restarts
        Of the heuristic that prices before the program does: disturbed copies of its best order.
    roundings
        So many beginnings of the fractional cover are completed by the heuristic.
    proof
        Millions of comparisons spent on the bound over sets that may fit; some 170 a second.
    """

    effort: float = 0.01
    rounds: int = 60
    restarts: int = 10
    roundings: int = 8
    proof: float = 400.0

    def __post_init__(self) -> None:
        super().__post_init__()
        _at_least("rounds", self.rounds, 0)
        _at_least("restarts", self.restarts, 0)
        _at_least("roundings", self.roundings, 0)
        _at_least("proof", self.proof, 0)
