"""The rules that supports are planned by; the job file's section `[supports]` is read into them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import LARGEST_COST, Escalation
from amprep.model.supports.rules import SupportRules
from amprep.validation import LARGEST_COUNT, require_bounds


@dataclass(frozen=True)
class PlanningRules(SupportRules):
    """Rules for the grid and the routing of supports.

    Attributes
    ----------
    pitch_mm
        Horizontal voxel size; None lets `amprep.supports.grid.sizing.choose_pitch` choose it.
    memory_mb
        Memory that the grid may take.
    edge_capacity, node_capacity
        Largest number of paths on one edge and through one square; 0 for no limit.
    load_area_mm2
        Overhang area that one edge may carry; 0 for no limit.
    load_height_mm
        Height up to which a support carries that area; the area of a taller support is smaller by the square of
        the height, as for columns that buckle (Euler). 0 for no influence of the height.
    escalation
        Capacities that are raised when they leave red squares unconnected (thesis 3.3).
    vertical_cost, oblique_cost
        Cost of one path on a vertical and on an oblique edge.
    share_between_parts
        ``avoid``: parts share supports only where a red square would otherwise stay unconnected; ``allow``: all
        parts are routed as one network.
    """

    REPLACED_KEYS: ClassVar[Mapping[str, str]] = {
        "cross_bracing": "leg_ratio",
        "slenderness_ratio": "leg_ratio",
    }
    """Keys of earlier releases, each with the key that takes its place."""

    pitch_mm: float | None = None
    memory_mb: int = 2000
    edge_capacity: int = 0
    node_capacity: int = 0
    load_area_mm2: float = 0.0
    load_height_mm: float = 0.0
    escalation: Escalation = "cut"
    vertical_cost: int = 1
    oblique_cost: int = 2
    share_between_parts: Literal["avoid", "allow"] = "avoid"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_noncritical()
        require_bounds(self, "pitch_mm", above=0)
        require_bounds(self, "memory_mb", at_least=1, at_most=LARGEST_COUNT)
        require_bounds(self, "edge_capacity", "node_capacity", at_least=0, at_most=LARGEST_COUNT)
        require_bounds(self, "load_area_mm2", "load_height_mm", at_least=0)
        require_bounds(self, "vertical_cost", "oblique_cost", at_least=1, at_most=LARGEST_COST)

    def edge_limit(self, grid: Grid, top: int) -> int:
        """Return the capacity of the edges below red squares up to plane `top`; 0 for no limit.

        One path carries the overhang area of one square. The limit by load is at least one path.
        """
        if not self.load_area_mm2:
            return self.edge_capacity
        height = top * grid.step
        weaker = min(1.0, self.load_height_mm / height) ** 2 if self.load_height_mm and height else 1.0
        paths = int(min(self.load_area_mm2 * weaker / grid.pitch**2 + 1e-9, LARGEST_COUNT))
        return min(max(1, paths), self.edge_capacity or max(1, paths))
