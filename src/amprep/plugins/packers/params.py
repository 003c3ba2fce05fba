"""Parameters of the built-in packers."""

from dataclasses import dataclass

from amprep.validation import require, require_bounds

MOST_STARTS = 1000
"""Largest number of searches of one packer."""


@dataclass(frozen=True)
class ExtremePointsParams:
    """Parameters of `extreme-points`; the budgets count work, so that the same job gives the same packing.

    Attributes
    ----------
    orderings
        Greatest number of constructive passes, each with an ordering and a placement rule. 0 means 12 for a builds
        problem with stacking in a box-shaped build volume, else all.
    restarts
        Further passes over randomly disturbed copies of the best ordering.
    disturbance
        Greatest distance by which a restart moves an item in the ordering, as a fraction of the number of items.
    work
        Millions of comparisons of boxes and points after which no further pass is begun; some 200 per second.
    starts
        Number of searches, each with random numbers of its own; the best packing counts.
    """

    orderings: int = 0
    restarts: int = 0
    disturbance: float = 0.1
    work: float = 200.0
    starts: int = 1

    def __post_init__(self) -> None:
        require_bounds(self, "starts", at_least=1, at_most=MOST_STARTS)
        require(self.starts == 1 or self.restarts > 0, "starts must be 1 without restarts", self.starts)
        require_bounds(self, "orderings", "restarts", "work", at_least=0)
        require_bounds(self, "disturbance", above=0, at_most=1)


@dataclass(frozen=True)
class TabuParams:
    """Parameters of `tabu`; the budget counts work, so that the same job gives the same packing.

    Attributes
    ----------
    start
        ``separate``: every item in its own build, as in the thesis; ``heuristic``: the sub-heuristic's packing.
    max_tuple_size
        Greatest number of builds that are packed again at once (the thesis's k_max).
    max_diversifications
        Diversifications before a strong one (the thesis's d_max).
    tenure
        Number of the last penalties that are tabu, for each size of tuple.
    count_weight
        Weight w of the filling function: fraction of the volume less w times the fraction of the items; 0 as in the
        thesis, where the number of items only breaks ties.
    patience
        Strong diversifications without a better packing after which the search ends.
    work
        Millions of comparisons of boxes after which the search ends; some 200 per second.
    """

    start: str = "separate"
    max_tuple_size: int = 3
    max_diversifications: int = 3
    tenure: int = 3
    count_weight: float = 0.0
    patience: int = 3
    work: float = 100.0

    def __post_init__(self) -> None:
        known = self.start in {"separate", "heuristic"}
        require(known, "start must be separate or heuristic", repr(self.start))
        require_bounds(self, "max_tuple_size", at_least=1)
        require_bounds(self, "max_diversifications", "tenure", "count_weight", "patience", "work", at_least=0)


@dataclass(frozen=True)
class AutoParams:
    """Parameters of `auto`; the budgets count work, so that the same job gives the same packing.

    Attributes
    ----------
    ruin_size
        Greatest number of builds that one step empties and packs again.
    temperature
        Temperature of the acceptance rule, in units of the mean item volume.
    patience
        Steps per item after which the search for one build less ends; in a fill problem, the number of disturbed
        orderings.
    work
        Millions of comparisons after which the search ends; some 40 per second.
    proof
        Millions of comparisons spent on the bound, in a second thread; some 170 per second.
    boxes
        Fraction of both budgets for the enclosing boxes, where true shapes are packed after them.
    separation
        Millions of field values that `separation` reads, with stacking; some 300 to 1000 per second. 0: boxes alone.
    plates
        Millions of field values that `plates` reads, without stacking; some 500 to 1000 per second. 0: boxes alone.
    starts
        Number of searches, each with random numbers of its own; the best packing counts.
    """

    ruin_size: int = 3
    temperature: float = 0.05
    patience: int = 1000
    work: float = 100.0
    proof: float = 400.0
    boxes: float = 0.2
    separation: float = 2500.0
    plates: float = 8000.0
    starts: int = 1

    def __post_init__(self) -> None:
        require_bounds(self, "starts", at_least=1, at_most=MOST_STARTS)
        require_bounds(self, "ruin_size", at_least=1)
        require_bounds(self, "temperature", "patience", "work", "proof", at_least=0)
        require_bounds(self, "separation", "plates", at_least=0)
        require_bounds(self, "boxes", at_least=0, at_most=1)


@dataclass(frozen=True)
class SweepParams:
    """Parameters of `sweep`.

    Attributes
    ----------
    slicings
        Greatest number of choices of axes and orders that are tried; 0 means all.
    """

    slicings: int = 0

    def __post_init__(self) -> None:
        require_bounds(self, "slicings", at_least=0)


@dataclass(frozen=True)
class BlockBuildingParams:
    """Parameters of `block-building`; the budget counts work, so that the same job gives the same packing.

    Attributes
    ----------
    blocks
        Greatest number of blocks of each of the two searches; there is always one for each single box.
    work
        Millions of tested blocks and spaces after which the searches end; some 200 per second.
    """

    blocks: int = 10_000
    work: float = 500.0

    def __post_init__(self) -> None:
        require_bounds(self, "blocks", "work", at_least=0)


@dataclass(frozen=True)
class IpParams:
    """Parameters of `ip`.

    Attributes
    ----------
    start
        The packing that the solver starts from in a fill problem: ``blocks``, the better one of extreme points and
        block building; ``extreme-points``; or ``none``, to compare: then the packing of the solver counts, even where
        a heuristic finds a better one.
    solver
        Name of the solver in pulp. Only HiGHS obeys `effort`, `threads` and `seed`, starts from the heuristic's
        packing and reports its bound; any other solver obeys the time limit alone.
    effort
        Millions of branch-and-bound nodes times direction variables after which the solver is stopped.
    directions
        Greatest number of direction variables; with more of them the heuristic's packing is the result.
    sharing
        The alternative copies of an item, one per orientation, share one position and one set of directions. If
        false, each copy has its own (thesis 2.2).
    symmetry
        Equal items, builds and mirror images are put in one order.
    tighten
        Each big-M is the least one for its pair, directions without room are left out, no two opposite directions
        hold, and the volume of a build is a constraint. If false, the program is as in the thesis.
    threads
        Threads of the solver; with more than one the result may differ from run to run.
    seed
        Seed of the solver.
    """

    start: str = "blocks"
    solver: str = "HiGHS"
    effort: float = 0.05
    directions: int = 20_000
    sharing: bool = True
    symmetry: bool = True
    tighten: bool = True
    threads: int = 1
    seed: int = 0

    def __post_init__(self) -> None:
        known = self.start in {"blocks", "extreme-points", "none"}
        require(known, "start must be blocks, extreme-points or none", repr(self.start))
        require_bounds(self, "effort", "directions", "seed", at_least=0)
        require_bounds(self, "threads", at_least=1)


@dataclass(frozen=True)
class IpLocalSearchParams(IpParams):
    """Parameters of `ip-local-search`; those of `ip` apply to the programs of the neighbourhoods.

    Symmetry is not broken by default, because exchanging equal items would count as distance.

    Attributes
    ----------
    used_distance
        Greatest number of items that enter or leave in one step (thesis 2.2; `used_d` in chapter 4).
    direction_distance
        Greatest number of directions that change in one step, between pairs that stay (`dir_d`).
    growth
        Factor by which both distances grow where nothing better is found; at 1 the search ends instead.
    steps
        Greatest number of programs that are solved.
    """

    symmetry: bool = False
    used_distance: int = 5
    direction_distance: int = 20
    growth: float = 1.5
    steps: int = 10

    def __post_init__(self) -> None:
        super().__post_init__()
        require_bounds(self, "used_distance", "growth", "steps", at_least=1)
        require_bounds(self, "direction_distance", at_least=0)


@dataclass(frozen=True)
class ColumnGenerationParams(IpParams):
    """Parameters of `column-generation`; those of `ip` apply to each pricing program and to the cover.

    Attributes
    ----------
    rounds
        Greatest number of times that the cover is solved and builds are priced.
    restarts
        Restarts of the heuristic that prices first: disturbed copies of its best ordering.
    roundings
        Number of beginnings of the fractional cover that the heuristic completes.
    proof
        Millions of comparisons spent on the fractional covering bound; some 170 per second.
    """

    start: str = "extreme-points"
    effort: float = 0.01
    rounds: int = 60
    restarts: int = 10
    roundings: int = 8
    proof: float = 400.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_bounds(self, "rounds", "restarts", "roundings", "proof", at_least=0)


@dataclass(frozen=True)
class SeparationParams:
    """Parameters of `separation`; the budget counts work, so that the same job gives the same packing.

    Attributes
    ----------
    step
        Distance of the samples of the fields, as a fraction of the mean size of the items.
    memory
        Greatest size of the fields in MB; the step grows where they would need more.
    scan_chance
        Probability that a move scans the whole build volume when a descent leaves an overlap.
    shrink
        Fraction by which the height is reduced after a success; after failures less.
    persistence
        Spans of ten rounds without progress after which a layout is given up and disturbed.
    workers
        Threads that search side by side. The packing depends on their number.
    failures
        Layouts given up one after another at which a worker ends. Without a value any number if time or work is
        limited, else 20.
    work
        Millions of field values read by all workers after which the search ends; some 300 to 1000 per second and
        worker. Computing the fields does not count. Without a value, a time limit is used up, or the work is 6000.
    starts
        Number of searches, each with random numbers of its own; the best packing counts.
    """

    step: float = 0.06
    memory: float = 400.0
    scan_chance: float = 0.5
    shrink: float = 0.01
    persistence: int = 40
    workers: int = 2
    failures: int | None = None
    work: float | None = None
    starts: int = 1

    def __post_init__(self) -> None:
        require_bounds(self, "starts", at_least=1, at_most=MOST_STARTS)
        require_bounds(self, "step", above=0, at_most=0.5)
        require_bounds(self, "scan_chance", "failures", "work", at_least=0)
        require_bounds(self, "workers", at_least=1, at_most=64)
        require_bounds(self, "shrink", above=0, at_most=0.5)
        require_bounds(self, "memory", "persistence", at_least=1)


@dataclass(frozen=True)
class PlatesParams:
    """Parameters of `plates`; the budget counts work, so that the same job gives the same layout.

    Attributes
    ----------
    step
        Distance of the samples of the fields, as a fraction of the mean size of the shadows.
    memory
        Greatest size of the cache of fields in MB; where it is full, fields are computed again.
    angle_step_deg
        Step of the turns about z of a part that may be turned by any angle, degrees.
    tolerance
        Length (mm) by which the outline of a shadow may be simplified outwards.
    support_margin_mm
        Width (mm) of the margin around the shadows of parts with faces that hang over, for the base of their supports.
    scan_chance
        Probability that a move scans plates when a descent leaves an overlap.
    passes
        Constructive passes before the search.
    persistence
        Spans of four rounds without progress after which a layout is given up and disturbed.
    failures
        Layouts given up one after another at which the search ends.
    work
        Millions of field values read or computed after which the search ends; some 500 to 1000 per second.
    starts
        Number of searches, each with random numbers of its own; the best packing counts.
    """

    step: float = 0.035
    memory: float = 500.0
    angle_step_deg: float = 15.0
    tolerance: float = 0.05
    support_margin_mm: float = 0.0
    scan_chance: float = 0.5
    passes: int = 5
    persistence: int = 30
    failures: int = 200
    work: float = 30000.0
    starts: int = 1

    def __post_init__(self) -> None:
        require_bounds(self, "starts", at_least=1, at_most=MOST_STARTS)
        require_bounds(self, "step", above=0, at_most=0.5)
        require_bounds(self, "angle_step_deg", above=0, at_most=360)
        require_bounds(self, "tolerance", "support_margin_mm", "scan_chance", "work", "failures", at_least=0)
        require_bounds(self, "memory", "passes", "persistence", at_least=1)
