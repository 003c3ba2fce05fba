"""Find long straight edges that the recoater blade meets at once."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.slicing.planar_faces import PlanarFaces, find_planar_faces
from amprep.geometry.slicing.straight_traces import Traces, straight_traces
from amprep.model import Build, Part
from amprep.validation import require_bounds

ANGLE_TOLERANCE = 1e-3
"""Degrees; files round the matrices of placed parts."""


@dataclass(frozen=True)
class BladeRules:
    """Which edges the recoater blade must not meet at once.

    Attributes
    ----------
    recoater_deg
        Direction in which the blade moves, in degrees from x to y; the blade is perpendicular to it.
    angle_deg
        Least angle between an edge and the blade.
    edge_mm
        Longest edge that may be closer to parallel to the blade.
    """

    recoater_deg: float = 0.0
    angle_deg: float = 5.0
    edge_mm: float = 10.0

    def __post_init__(self) -> None:
        require_bounds(self, "angle_deg", at_least=0, at_most=45)
        require_bounds(self, "edge_mm", above=0)

    def off_blade(self, edges_deg: Floats) -> Floats:
        """Return the angles (degrees, 0 to 90) between the blade and edges of these directions in plan."""
        blade = self.recoater_deg + 90.0
        return np.abs((edges_deg - blade + 90.0) % 180.0 - 90.0)

    def meets_blade(self, edges_deg: Floats) -> Bools:
        """Tell which edges of these directions in plan (degrees) the blade meets at once."""
        return np.asarray(self.off_blade(edges_deg) < self.angle_deg - ANGLE_TOLERANCE, np.bool_)


@dataclass(frozen=True)
class BladeEdge:
    """The longest edge of a part that meets the recoater blade at once.

    Attributes
    ----------
    part
        Index of the part in its build.
    length_mm
        Its length.
    off_deg
        Angle between it and the blade.
    position_mm
        Its middle in build coordinates.
    low_mm, high_mm
        Heights between which layers have edges of the same planar face.
    faces
        Number of planar faces of the part that have such edges.
    """

    part: int
    length_mm: float
    off_deg: float
    position_mm: tuple[float, float, float]
    low_mm: float
    high_mm: float
    faces: int = 1


def measure_blade_edges(build: Build, rules: BladeRules) -> tuple[BladeEdge, ...]:
    """Return for each part of a build the longest edge that meets the blade at once, if there is one.

    Edges are straight: those of the layers on one planar face. A slender facet of a curved face counts, too, so that a
    lying cylinder has an edge as long as it is.
    """
    known: dict[int, PlanarFaces] = {}
    found = []
    for number, placed in enumerate(build.parts):
        if id(placed.part) not in known:
            known[id(placed.part)] = planar_faces_of(placed.part)
        faces = known[id(placed.part)]
        traces = straight_traces(faces, rules.edge_mm, placed.matrix[:3, :3], rules.meets_blade)
        if len(traces.length):
            found.append(_edge(number, traces, rules, placed.matrix[:3, 3]))
    return tuple(found)


def planar_faces_of(part: Part) -> PlanarFaces:
    """Return the planar faces of a part in part coordinates."""
    return find_planar_faces(part.mesh.vertices, part.mesh.triangles.astype(np.int64))


def _edge(number: int, traces: Traces, rules: BladeRules, shift: Floats) -> BladeEdge:
    longest = int(traces.length.argmax())
    x, y, z = (traces.middle[longest] + shift).tolist()
    return BladeEdge(
        number,
        float(traces.length[longest]),
        float(rules.off_blade(traces.angle_deg)[longest]),
        (x, y, z),
        float(traces.low[longest] + shift[2]),
        float(traces.high[longest] + shift[2]),
        len(traces.length),
    )
