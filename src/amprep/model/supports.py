"""The support problem on the layered grid (thesis 3.2) and its answer."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Literal

import numpy as np

from amprep.arrays import Bools, Bytes, Ints, frozen
from amprep.errors import JobError
from amprep.geometry.voxels.grid import Grid
from amprep.model.support_edges import SupportEdges

Status = Literal["optimal", "feasible", "infeasible"]

Escalation = Literal["none", "cut", "uniform"]
"""What gives way when capacities leave out red squares that have a way to the plate: nothing; the smallest
capacities of a minimum cut, by one at a time, vertical edges first; or all capacities alike (thesis 3.3)."""

NO_FREE_VOXEL_BELOW = "no free voxel below"
ENCLOSED = "enclosed"
CAPACITY = "capacity"
CONNECTOR_BLOCKED = "connector blocked"
OUT_OF_TIME = "time limit"


LARGEST_COST = 10_000
"""Bound on the integer cost of an edge: sums over a path stay far inside 32 bits."""


class Voxel(IntEnum):
    """State of a grid voxel: white may carry supports."""

    FREE = 0
    OCCUPIED = 1
    CLOSED = 2


@dataclass(frozen=True, eq=False)
class SupportProblem:
    """Connect red squares to green ones over free voxels, downwards, at most one square sideways a layer.

    An edge leads from square (p, y, x) to (p - 1, y + dy, x + dx) and exists when the voxels
    (p - 1, y, x) and (p - 1, y + dy, x + dx) are both white.

    Attributes
    ----------
    voxels
        ``(nz, ny, nx)`` uint8, values of `Voxel`.
    red
        ``(m, 3)`` int32 plane, y, x, distinct, each with plane >= 1; the voxel below is white.
    red_part, red_region
        ``(m,)`` int32: which placed part, which of its overhang regions.
    green
        ``(ny, nx)`` bool: plate squares under a free voxel.
    edge_capacity, node_capacity
        Paths that may share an edge, a square; 0 means unbounded. A red square's own supply is 1.
    escalation
        What gives way when the capacities leave out red squares that have a way.
    costs
        Integer cost of one unit over a vertical and over an oblique edge, from 0 to `LARGEST_COST`.
    material
        Material of a vertical and of an oblique edge in the chosen cell, mm3.
    """

    frame: Grid
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
            raise JobError(f"costs of edges must be from 0 to {LARGEST_COST}, got {list(self.costs)}")


@dataclass(frozen=True)
class Unconnected:
    """A red square (index into the problem's `red`) without a way to the plate, and why."""

    red: int
    reason: str


@dataclass(frozen=True, eq=False)
class SupportPlan:
    """Answer to a `SupportProblem`: the edges that carry flow, and the red squares that stay unconnected.

    Attributes
    ----------
    edges
        Each edge once, with flow 1 or more.
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
