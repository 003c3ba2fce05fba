"""What the program that opens a build file would print, read from the file without amprep's own metadata."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from amprep.arrays import Bools, Floats, frozen
from amprep.model.mesh import Mesh

PrintedKind = Literal[
    "model", "support", "open support", "surface", "negative", "modifier", "blocker", "enforcer", "nothing"
]
"""How a program treats a body: filled as a part, filled as a support, as a support or a surface that is not filled,
subtracted, as a region with settings, or not at all."""


@dataclass(frozen=True, eq=False)
class PrintedBeams:
    """The beams of a body.

    Attributes
    ----------
    ends
        ``(m, 2, 3)`` mm, build coordinates.
    radii
        ``(m, 2)`` mm.
    round_caps
        ``(m,)`` whether both ends are spheres.
    has_balls
        Whether nodes have balls of their own.
    clipping
        The mesh that clips the beams, in build coordinates; None if nothing clips them.
    keeps_inside
        Whether the part of the beams inside the clipping mesh remains, rather than the part outside.
    """

    ends: Floats
    radii: Floats
    round_caps: Bools
    has_balls: bool
    clipping: Mesh | None
    keeps_inside: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "ends", frozen(self.ends, np.float64).reshape(-1, 2, 3))
        object.__setattr__(self, "radii", frozen(self.radii, np.float64, 2))
        object.__setattr__(self, "round_caps", frozen(self.round_caps, np.bool_))


@dataclass(frozen=True, eq=False)
class PrintedBody:
    """A body that the program would make of a part of the file.

    Attributes
    ----------
    name
        Its name in the file.
    mesh
        Its triangles in build coordinates, mm; may be empty if there are beams.
    """

    name: str
    kind: PrintedKind
    mesh: Mesh
    beams: PrintedBeams | None = None


@dataclass(frozen=True, eq=False)
class PrintedFile:
    """The bodies that the program would make of a file.

    Attributes
    ----------
    program
        Name of the program, to begin a sentence with.
    unit_mm
        Length of the file's unit, mm.
    bodies
        All bodies, also those that are not printed.
    remarks
        One sentence for everything else in the file by which the program would print something else than amprep wrote.
    """

    program: str
    unit_mm: float
    bodies: tuple[PrintedBody, ...]
    remarks: tuple[str, ...] = ()
