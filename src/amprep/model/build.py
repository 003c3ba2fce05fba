"""One finished build: what a build file says, and what `amprep verify` reads back."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from amprep.model.arrays import Floats, frozen
from amprep.model.mesh import Mesh
from amprep.model.part import Orientations, Part
from amprep.model.space import BuildVolume

Grounding = Literal["plate", "anywhere"]
Target = Literal["generic", "prusaslicer", "cura"]
TARGETS: tuple[Target, ...] = ("generic", "prusaslicer", "cura")


@dataclass(frozen=True, eq=False)
class BuildSettings:
    """The rules a build was made under; written into the file so that it can be judged from the file alone.

    Attributes
    ----------
    build_id
        Names the job and the number of the build, e.g. ``bracket.build-1``.
    clearance, lift, gap, overlap, reach
        mm; `reach` is how far an overhang may lie from the nearest contact.
    overhang_angle_deg, strut_angle_deg
        Job-wide; a part's own override travels with the part.
    least_area, least_length
        mm2 and mm; overhangs smaller than that need no support.
    supported
        False when the job asked for no supports.
    grounding
        ``plate``: all supports stand on it; ``anywhere``: some may stand on the parts they hold.
    """

    build_id: str
    space: BuildVolume
    target: Target = "generic"
    printer: str = ""
    clearance: float = 0.0
    lift: float = 0.0
    gap: float = 0.0
    overlap: float = 0.1
    reach: float = 1.5
    overhang_angle_deg: float = 45.0
    strut_angle_deg: float = 45.0
    least_area: float = 0.5
    least_length: float = 0.5
    supported: bool = True
    grounding: Grounding = "plate"


@dataclass(frozen=True, eq=False)
class PlacedPart:
    """A part where it stands in the build.

    Attributes
    ----------
    label
        Name within the build, unique: the part's name, with ``-2`` and so on for further copies.
    matrix
        ``(4, 4)`` part coordinates to build coordinates.
    recorded_digest
        `Mesh.digest` that a build file states for this part; empty while the build is being made.
    """

    label: str
    part: Part
    matrix: Floats
    orientations: Orientations = field(default_factory=Orientations)
    recorded_digest: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrix", frozen(self.matrix, np.float64).reshape(4, 4))

    @property
    def mesh(self) -> Mesh:
        """The mesh in build coordinates."""
        return self.part.mesh.moved(self.matrix)


@dataclass(frozen=True, eq=False)
class SupportBody:
    """Finished support geometry of one group, in build coordinates.

    Attributes
    ----------
    parts
        Indices of the placed parts it holds; more than one only where supports are shared.
    surface
        True for walls without thickness, which a machine must not fill.
    """

    name: str
    mesh: Mesh
    parts: tuple[int, ...]
    surface: bool = False


@dataclass(frozen=True, eq=False)
class Unsupported:
    """A listed region that needs support and has none within reach.

    Attributes
    ----------
    part
        Index of the placed part.
    label
        For people: ``overhang 7 of bracket-2``.
    kind
        ``face``, ``edge`` or ``tip``.
    reason
        One of the four reasons of `amprep.model.supports`.
    measure
        Unsupported area in mm2, length in mm, or 0 for a tip.
    points
        ``(n, 3)`` mm, build coordinates: every point of the region lies within `radius` of one of them.
    minor
        Whether it is smaller than the least area or length to support, beside held surface: listed, no fault.
    """

    part: int
    label: str
    kind: str
    reason: str
    measure: float
    points: Floats
    radius: float
    minor: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, np.float64, 3))


@dataclass(frozen=True, eq=False)
class Build:
    """One printing run, complete: rules, parts, supports, and what stayed unsupported."""

    settings: BuildSettings
    parts: tuple[PlacedPart, ...]
    supports: tuple[SupportBody, ...] = ()
    unsupported: tuple[Unsupported, ...] = ()
