"""Parameters of the packers that solve integer programs."""

from dataclasses import dataclass


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
        off: each copy has its own (thesis 2.1).
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


def _at_least(name: str, value: float, least: float) -> None:
    if not value >= least:
        raise ValueError(f"{name} must be at least {least}, got {value}")


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
