"""Parameters of the packer `annealing`."""

from dataclasses import dataclass

from amprep.plugins.packers.params import MOST_STARTS
from amprep.validation import require, require_bounds

SCHEDULES = ("geometric", "linear", "adaptive")
STARTS = ("extreme-points", "auto", "sweep", "separation", "outside")
COLLISIONS = ("any", "boxes", "trees", "pieces")


@dataclass(frozen=True)
class AnnealingParams:
    """Parameters of `annealing`; the budget counts moves, so that the same job gives the same packing.

    Temperatures are in units of the mean value of the items (their mean volume for `builds` and `height`).

    Attributes
    ----------
    start
        The first layout: ``separation``: that packer on the shapes themselves, in at most three quarters of the time
        (without stacking, or when this is too short, `extreme-points`); the packer `extreme-points`, `auto` or `sweep`
        on enclosing boxes; ``outside``: all items are beside the build volume, as in the thesis.
    moves
        Moves per item, accepted or not.
    cycle
        Moves per item from the first temperature to the last one; then the best layout is annealed again. With the
        schedule ``adaptive``, the moves without an improvement after which the temperature rises again.
    schedule
        Course of the temperature: ``geometric``, ``linear`` or ``adaptive``.
    temperature, last_temperature
        First and last temperature of a cycle.
    gravity
        Energy of an item of mean volume at the top of the layout; the energy grows with the square of the height.
    max_travel
        Longest move, as a fraction of the longest side of the build volume (the thesis's mmd).
    max_angle_deg
        Greatest angle of a rotation.
    drops
        Probability of a re-insertion: an item is taken out and let down from above at a random place. At 0 all items
        move continuously, as in the thesis.
    turns
        Probability of a rotation, for parts that may be turned by any angle.
    sinks
        Probability that a translation in the build volume goes downwards as far as possible.
    shrink
        For `height`: fraction by which the next layout must be lower than the best one.
    collision
        Collision engine: ``boxes`` (exact for boxes), ``trees`` (OBB trees of meshes) or ``pieces`` (convex pieces);
        ``any`` takes the first of them that can handle the volumes, the pieces only if all volumes are convex pieces.
    starts
        Number of searches, each with random numbers of its own; the best packing counts.
    """

    start: str = "separation"
    moves: int = 2000
    cycle: int = 500
    schedule: str = "geometric"
    temperature: float = 0.05
    last_temperature: float = 0.001
    gravity: float = 1.0
    max_travel: float = 0.2
    max_angle_deg: float = 15.0
    drops: float = 0.5
    turns: float = 0.03
    sinks: float = 0.5
    shrink: float = 0.002
    collision: str = "any"
    starts: int = 1

    def __post_init__(self) -> None:
        require_bounds(self, "starts", at_least=1, at_most=MOST_STARTS)
        for name, known in (("start", STARTS), ("schedule", SCHEDULES), ("collision", COLLISIONS)):
            value = getattr(self, name)
            require(value in known, f"{name} must be one of {', '.join(known)}", repr(value))
        require_bounds(self, "moves", at_least=0, at_most=1_000_000)
        require_bounds(self, "cycle", at_least=1, at_most=1_000_000)
        require_bounds(self, "temperature", "last_temperature", "max_travel", "max_angle_deg", above=0)
        require_bounds(self, "max_angle_deg", at_most=180)
        require_bounds(self, "gravity", at_least=0)
        require_bounds(self, "drops", "turns", "sinks", at_least=0, at_most=1)
        require_bounds(self, "shrink", above=0, at_most=0.5)
        require(self.drops + self.turns <= 1, "drops + turns must be at most 1", self.drops + self.turns)
        cooling = self.last_temperature <= self.temperature
        require(cooling, "last_temperature must be at most temperature", self.last_temperature)
