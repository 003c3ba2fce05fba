"""The support problem on the grid (thesis 3.2), and the plan that answers it."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Literal

import numpy as np

from amprep.arrays import Bools, Bytes, Ints, frozen
from amprep.errors import JobError
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports.edges import SupportEdges

Status = Literal["optimal", "feasible", "infeasible"]

Escalation = Literal["none", "cut", "uniform"]
"""Capacities that are raised when they leave reachable red squares unconnected: none; those of a minimum cut, by
one path at a time, vertical edges first; or all by the same number (thesis 3.3)."""

NO_FREE_VOXEL_BELOW = "no free voxel below"
ENCLOSED = "enclosed"
CAPACITY = "capacity"
CONNECTOR_BLOCKED = "connector blocked"
OUT_OF_TIME = "time limit"
EXCEPTED = "rule"
TERRITORY = "territory"
SLENDER = "slender"

REASONS = {
    NO_FREE_VOXEL_BELOW: "the voxels directly below contain material of a part or are outside the grid",
    ENCLOSED: "there is a free voxel below, but no path from there to the build plate",
    CAPACITY: "there is a path, but `edge_capacity` or `node_capacity` is used up on it",
    CONNECTOR_BLOCKED: (
        "a support stands below, but other material of the part is between, or contact would be too small"
    ),
    OUT_OF_TIME: "there is a path, but the routing ended before it was found",
    EXCEPTED: "a `[[rule]]` entry of the job with `support = false` takes the region; it is no fault",
    TERRITORY: "there is a path, but it leaves the territory of the part or drifts too far",
    SLENDER: "there is a path, but a support there would be a leg longer than `leg_ratio` allows",
}
"""All reasons why an overhang is unsupported, with their explanations; routers use three of them."""

ROUTER_REASONS = (ENCLOSED, CAPACITY, OUT_OF_TIME)
"""Reasons that a router may give for an unconnected red square; the last one only if it ended early."""

LARGEST_COST = 10_000
"""Largest integer cost of an edge; sums over a path then fit into 32 bits."""


class Voxel(IntEnum):
    """State of a voxel: free for supports, occupied by a part, or closed (outside the build volume)."""

    FREE = 0
    OCCUPIED = 1
    CLOSED = 2


@dataclass(frozen=True, eq=False)
class SupportProblem:
    """Connect red squares with green squares by paths over free voxels (thesis 3.2).

    An edge leads from square (p, y, x) down to (p - 1, y + dy, x + dx), at most one square sideways. It exists if
    the voxels (p - 1, y, x) and (p - 1, y + dy, x + dx) are both free.

    Attributes
    ----------
    grid
        Position and size of the voxels.
    voxels
        ``(nz, ny, nx)`` uint8, values of `Voxel`.
    red
        ``(m, 3)`` int32 plane, y, x; distinct, with plane >= 1 and a free voxel below.
    red_part, red_region
        ``(m,)`` int32: placed part, and its overhang region.
    green
        ``(ny, nx)`` bool: plate squares below a free voxel.
    edge_capacity, node_capacity
        Largest number of paths on an edge and through a square; 0 for no limit. The path that starts at a red
        square counts in it.
    costs
        Integer cost of one path on a vertical and on an oblique edge, from 0 to `LARGEST_COST`.
    material
        Material of a vertical and of an oblique edge in the chosen cell, mm3.
    escalation
        Capacities that are raised when they leave reachable red squares unconnected.

    Raises
    ------
    JobError
        If a cost is out of bounds.
    """

    grid: Grid
    voxels: Bytes
    red: Ints
    red_part: Ints
    red_region: Ints
    green: Bools
    edge_capacity: int = 0
    node_capacity: int = 0
    costs: tuple[int, int] = (1, 2)
    material: tuple[float, float] = (1.0, 1.0)
    escalation: Escalation = "none"

    def __post_init__(self) -> None:
        object.__setattr__(self, "voxels", frozen(self.voxels, np.uint8))
        object.__setattr__(self, "red", frozen(self.red, np.int32, 3))
        object.__setattr__(self, "red_part", frozen(self.red_part, np.int32))
        object.__setattr__(self, "red_region", frozen(self.red_region, np.int32))
        object.__setattr__(self, "green", frozen(self.green, np.bool_))
        if not all(0 <= cost <= LARGEST_COST for cost in self.costs):
            raise JobError(f"costs of edges must be between 0 and {LARGEST_COST}, got {list(self.costs)}")


@dataclass(frozen=True)
class Unconnected:
    """An unconnected red square (index into the problem's `red`), and the reason, one of `ROUTER_REASONS`."""

    red: int
    reason: str


@dataclass(frozen=True, eq=False)
class SupportPlan:
    """Answer to a `SupportProblem`: the edges that carry flow, and the red squares that stay unconnected.

    Attributes
    ----------
    edges
        The edges that carry flow; each occurs once.
    unconnected
        The red squares without a path.
    status
        ``optimal`` only if the objective meets the bound.
    stop_reason
        ``finished``, or why the router ended early.
    objective
        Value that the router minimises, or None.
    raised
        Largest amount that escalation added to a capacity; 0 without escalation.
    bound
        Lower bound of the objective, or None.
    notes
        Sentences for the user: the choice made, its reason, and how the plan compares.
    """

    edges: SupportEdges
    unconnected: tuple[Unconnected, ...] = ()
    status: Status = "feasible"
    stop_reason: str = "finished"
    objective: float | None = None
    bound: float | None = None
    raised: int = 0
    notes: tuple[str, ...] = ()
