"""Parameters of the built-in support routers."""

from dataclasses import dataclass
from math import isfinite

from amprep.validation import require, require_bounds


@dataclass(frozen=True)
class ShortestPathsParams:
    """Parameters of the router `shortest-paths` (thesis 3.4).

    The thesis has g = 1, 0, 0, 0, 1, 2, 3, 4, a ratio of 0.1 and 30 rounds. With the defaults here, joining
    saves cost for more paths, and `paths_per_square` limits their number. The small cost of joining keeps the paths
    of a batch from all choosing the same squares; small batches follow each other's paths.

    Attributes
    ----------
    g
        Cost factor of one more path on an edge that carries 0, 1, 2, ... paths; beyond the table the last slope
        continues.
    reroute_ratio
        Fraction of the paths that each round rips up and reroutes, in (0, 1].
    rounds
        Number of rounds. A budget of work, so the same seed gives the same plan.
    seconds
        Time limit in addition to the rounds; None for none.
    neighbour_discount
        Fraction in [0, 1) by which an edge beside a square in use is cheaper.
    paths_per_square
        Most paths in a square, as long as everything can be connected within it; 0 for no limit. Capacities of the
        problem take its place.
    """

    g: tuple[float, ...] = (1.0, 0.15, 0.02, 0.0, 0.0)
    reroute_ratio: float = 0.05
    rounds: int = 60
    seconds: float | None = None
    neighbour_discount: float = 0.2
    paths_per_square: int = 9

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", tuple(float(cost) for cost in self.g))
        usable = self.g and all(isfinite(cost) and cost >= 0 for cost in self.g)
        require(bool(usable), "g must be a list of at least one cost, each at least 0", list(self.g))
        require_bounds(self, "reroute_ratio", above=0, at_most=1)
        require_bounds(self, "rounds", "paths_per_square", at_least=0)
        require_bounds(self, "seconds", above=0)
        require_bounds(self, "neighbour_discount", at_least=0, below=1)


@dataclass(frozen=True)
class TreeParams:
    """Parameters of the router `tree`.

    Attributes
    ----------
    rounds
        Number of reroutes tried. A budget of work, so the same seed gives the same plan.
    neighbours
        Number of neighbouring red squares that are rerouted at a time.
    seconds
        Time limit in addition to the rounds; None for none.
    paths_per_square
        Greatest number of paths in a square, as for `shortest-paths`.
    """

    rounds: int = 400
    neighbours: int = 12
    seconds: float | None = None
    paths_per_square: int = 9

    def __post_init__(self) -> None:
        require_bounds(self, "rounds", "paths_per_square", at_least=0)
        require_bounds(self, "neighbours", at_least=1)
        require_bounds(self, "seconds", above=0)
