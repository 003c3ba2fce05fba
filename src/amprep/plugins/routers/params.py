"""Parameters of the built-in support routers."""

from dataclasses import dataclass
from math import isfinite


@dataclass(frozen=True)
class ShortestPathsParams:
    """Parameters of the router `shortest-paths` (thesis 3.4).

    The thesis has g = 1, 0, 0, 0, 1, 2, 3, 4, a ratio of 0.1 and 30 rounds. The defaults here make joining pay for
    more paths and leave it to `paths_per_square` to limit them. The small price of joining keeps the paths of a
    batch from all choosing the same squares, and small batches follow each other's trunks.

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
        if not self.g or not all(isfinite(cost) and cost >= 0 for cost in self.g):
            raise ValueError(f"g must be a list of one or more costs >= 0, got {list(self.g)}")
        if not 0 < self.reroute_ratio <= 1:
            raise ValueError(f"reroute_ratio must be over 0 and at most 1, got {self.reroute_ratio}")
        if self.rounds < 0:
            raise ValueError(f"rounds must be 0 or more, got {self.rounds}")
        if self.seconds is not None and not self.seconds > 0:
            raise ValueError(f"seconds must be over 0, got {self.seconds}")
        if not 0 <= self.neighbour_discount < 1:
            raise ValueError(
                f"neighbour_discount must be at least 0 and under 1, got {self.neighbour_discount}"
            )
        if self.paths_per_square < 0:
            raise ValueError(f"paths_per_square must be 0 or more, got {self.paths_per_square}")


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
        As for `shortest-paths`.
    """

    rounds: int = 400
    neighbours: int = 12
    seconds: float | None = None
    paths_per_square: int = 9

    def __post_init__(self) -> None:
        for name, least in (("rounds", 0), ("neighbours", 1), ("paths_per_square", 0)):
            if getattr(self, name) < least:
                raise ValueError(f"{name} must be {least} or more, got {getattr(self, name)}")
        if self.seconds is not None and not self.seconds > 0:
            raise ValueError(f"seconds must be over 0, got {self.seconds}")
