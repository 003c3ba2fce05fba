"""The packing problem, and the packing that solves it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import JobError
from amprep.model.bounding_volume import BoundingVolume
from amprep.model.build_volume import BuildVolume
from amprep.model.part import Orientations

Objective = Literal["fill", "builds", "height"]
Status = Literal["optimal", "feasible", "infeasible"]
Interlocking = Literal["allow", "forbid"]
BoundFor = Literal["volumes", "shapes"]

LARGEST_VALUE = 10**15
"""Greatest value of an item: sums and ratios of values stay finite, and a double counts them to within 1."""


@dataclass(frozen=True, eq=False)
class Item:
    """One copy of a part in a packing problem.

    Attributes
    ----------
    part, copy
        Index of the part in the job, and of the copy, from 0.
    volume
        Bounding volume, mm, in the coordinates of the part after its rotation by `turn`; all copies share it.
    value
        Contribution to the objective of a fill problem.
    orientations
        Rotations that the packer may give the volume; they come after `turn`.
    turn
        ``(3, 3)`` rotation that the volume maker chose; the identity for a volume in part coordinates.
    exact
        Whether `volume` is the part itself and `orientations` are all that the part allows. A bound for the item is
        then one for the part.
    """

    part: int
    copy: int
    volume: BoundingVolume
    value: float
    orientations: Orientations = field(default_factory=Orientations)
    turn: Floats = field(default_factory=lambda: np.eye(3))
    exact: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "turn", frozen(self.turn, np.float64).reshape(3, 3))


@dataclass(frozen=True, eq=False)
class Placement:
    """A rigid motion of the volume of an item into a build: ``x -> rotation @ x + translation``."""

    item: int
    rotation: Floats
    translation: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "rotation", frozen(self.rotation, np.float64).reshape(3, 3))
        object.__setattr__(self, "translation", frozen(self.translation, np.float64))

    @property
    def matrix(self) -> Floats:
        """The motion as a ``(4, 4)`` row-major matrix for column vectors."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.rotation, self.translation
        return matrix


@dataclass(frozen=True, eq=False)
class PackingProblem:
    """Items, the build volume for them, an objective, and rules.

    Attributes
    ----------
    fixed
        Placements in the first build that must stay as they are.
    clearance
        Least distance between parts, and between parts and the walls and top of the build volume, mm. Bounding volumes
        do not include it.
    lift
        Height of the lowest parts above the plate, mm.
    stacking
        Whether parts may be above one another; if not, all of them are at `lift`.
    interlocking
        Whether parts may be locked into each other. A packer may ignore it: `amprep.repacking` then
        places locked parts elsewhere.
    """

    items: tuple[Item, ...]
    space: BuildVolume
    objective: Objective = "builds"
    fixed: tuple[Placement, ...] = ()
    clearance: float = 0.0
    lift: float = 0.0
    stacking: bool = True
    interlocking: Interlocking = "allow"

    @property
    def bound_for(self) -> BoundFor:
        """What a bound for all packings of the items applies to: the parts, if every item is exact."""
        return "shapes" if all(item.exact for item in self.items) else "volumes"


def require_values(problem: PackingProblem) -> None:
    """Refuse values of items that are not finite numbers from 0 to `LARGEST_VALUE`.

    Raises
    ------
    JobError
        For the first such item, with its part and value.
    """
    for item in problem.items:
        if not 0.0 <= item.value <= LARGEST_VALUE:
            raise JobError(
                f"part {item.part + 1}: the value must be between 0 and {float(LARGEST_VALUE):g}, got {item.value:g}; "
                f"correct it in the job file or the call"
            )


@dataclass(frozen=True)
class Unplaced:
    """An item in no build, and the reason: ``too large``, ``no room left`` or ``out of time``."""

    item: int
    reason: str


@dataclass(frozen=True)
class PackingStep:
    """A step of a packer that has several, and what the packing reaches after it.

    Attributes
    ----------
    method
        What was packed, and how, in a few words.
    reached
        Value of the objective: number of builds, total value, or height (mm).
    height
        Height (mm) of the highest build.
    seconds
        Duration of the step; steps are equal whatever their durations.
    """

    method: str
    reached: float
    height: float
    seconds: float = field(compare=False)


@dataclass(frozen=True, eq=False)
class Packing:
    """Builds of placements; every item is in exactly one build or in `unplaced`.

    Attributes
    ----------
    bound
        Proven bound on the objective: no packing has fewer builds, more value or less height. None when unknown.
    bound_for
        What `bound` applies to: ``volumes``, packings of the bounding volumes in the orientations that the packer was
        offered; or ``shapes``, any packing of the parts themselves.
    steps
        Steps of a packer that has several; empty for others.
    found_by
        The method that found the packing, where the packer has several: `ip` names its solver, or the heuristic that
        the solver started from. Else empty.
    excess
        For each solid that is placed as convex pieces, their total volume over that of the solid, less 1.
    """

    builds: tuple[tuple[Placement, ...], ...]
    unplaced: tuple[Unplaced, ...] = ()
    bound: float | None = None
    status: Status = "feasible"
    stop_reason: str = "finished"
    found_by: str = ""
    bound_for: BoundFor = "volumes"
    steps: tuple[PackingStep, ...] = ()
    excess: Mapping[int, float] = field(default_factory=dict)
