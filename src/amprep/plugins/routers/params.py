"""Parameters of the built-in support routers."""

from dataclasses import dataclass
from math import isfinite


@dataclass(frozen=True)
class ShortestPathsParams:
    """How `shortest-paths` draws and redraws (thesis 3.4).

    The thesis has g 1, 0, 0, 0, 1, 2, 3, 4, a ratio of 0.1 and 30 rounds. The defaults here let more paths join
    and leave it to `paths_per_square` that they do not become too many; the small price of joining keeps a
    batch from moving as a herd, and smaller batches follow each other's trunks.

    Attributes
    ----------
    g
        Cost factor of one more path on an edge that carries 0, 1, 2, ... paths; beyond the table the last
        slope continues.
    redraw_ratio
        Share of the paths redrawn in each round, in (0, 1].
    rounds
        Number of rounds; the budget that decides, so that results are reproducible.
    seconds
        Time limit in addition; None for none.
    neighbour_discount
        Share in [0, 1) taken off the cost of an edge beside a square in use.
    paths_per_square
        Paths that may meet in a square as long as everything can be connected that way; 0 for any number.
        The problem's own capacities, when set, take its place.
    """

    g: tuple[float, ...] = (1.0, 0.15, 0.02, 0.0, 0.0)
    redraw_ratio: float = 0.05
    rounds: int = 60
    seconds: float | None = None
    neighbour_discount: float = 0.2
    paths_per_square: int = 9

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", tuple(float(cost) for cost in self.g))
        if not self.g or not all(isfinite(cost) and cost >= 0 for cost in self.g):
            raise ValueError(f"g must be a list of one or more costs >= 0, got {list(self.g)}")
        if not 0 < self.redraw_ratio <= 1:
            raise ValueError(f"redraw_ratio must be over 0 and at most 1, got {self.redraw_ratio}")
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
    """How `tree` searches for the least material.

    Attributes
    ----------
    rounds
        Number of times that neighbours are redrawn; the budget that decides, so that results are reproducible.
    neighbours
        Number of red squares, side by side, whose paths are redrawn at a time.
    seconds
        Time limit in addition; None for none.
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
