"""The packer's promise, judged on the true meshes: inside, apart, out of the zones, moved only as allowed."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.checks.packing.motion import motion_fault
from amprep.checks.violation import Violation
from amprep.geometry.meshes.distance import box_solids, near_pairs, solid_distance, triangle_distance
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.build import BuildSettings, PlacedPart
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import Manifold

ROUNDING = 1e-4
"""mm; what the numbers of a build file may move a point by, on top of `CONTACT_TOLERANCE`."""

TOLERANCE = CONTACT_TOLERANCE + ROUNDING


class Body:
    """A placed part in build coordinates, its solid made when it is first needed."""

    def __init__(self, placed: PlacedPart, settings: BuildSettings) -> None:
        self.placed = placed
        self.label = placed.label
        self.is_solid = placed.part.is_solid
        own = placed.part.overrides
        self.clearance = settings.clearance if own.clearance_mm is None else own.clearance_mm
        self.lift = settings.lift if own.lift_mm is None else own.lift_mm

    @cached_property
    def mesh(self) -> Mesh:
        """The moved mesh."""
        return self.placed.mesh

    @cached_property
    def solid(self) -> "Manifold":
        """The moved mesh as a solid."""
        return as_manifold(self.mesh.vertices, self.mesh.triangles)

    @property
    def corners(self) -> Floats:
        """The triangles' corners, ``(m, 3, 3)`` mm."""
        return np.asarray(self.mesh.vertices[self.mesh.triangles])

    def gap(self, other: "Body", limit: float) -> float:
        """Return the distance to the other body, at most `limit`; negative when they overlap."""
        if self.is_solid and other.is_solid:
            return solid_distance(self.solid, other.solid, limit)
        return triangle_distance(self.corners, other.corners, limit)


def check_placed(parts: Sequence[PlacedPart], settings: BuildSettings, stop: Stop) -> list[Violation]:
    """Return how the parts of a build break the packer's promise.

    A part's own clearance and lift hold instead of the build's; between two parts the greater clearance does.
    Exact on the meshes: solids by manifold3d, surfaces triangle by triangle. Overlaps up to
    `CONTACT_TOLERANCE` are contact.
    """
    bodies = [Body(placed, settings) for placed in parts]
    found = [*_moved(bodies), *_unchanged(bodies)]
    bodies = [body for body in bodies if np.isfinite(body.mesh.vertices).all() and len(body.mesh.triangles)]
    found += [violation for body in bodies for violation in _inside(body, settings)]
    return [*found, *_zones(bodies, settings), *_apart(bodies, stop)]


def _moved(bodies: Sequence[Body]) -> list[Violation]:
    """Return the motions that are not allowed."""
    found = []
    for body in bodies:
        matrix = body.placed.matrix
        fault = motion_fault(matrix[:3, :3], body.placed.orientations)
        if not np.isfinite(matrix).all() or (matrix[3] != [0.0, 0.0, 0.0, 1.0]).any():
            fault = "is not a rigid motion"
        if fault:
            found.append(Violation("allowed motion", body.label, f"its placement {fault}"))
    return found


def _unchanged(bodies: Sequence[Body]) -> list[Violation]:
    """Return the parts whose geometry is not what the build file recorded."""
    return [
        Violation(
            "part unchanged", body.label, "its geometry differs from what the build file recorded (SHA-256)"
        )
        for body in bodies
        if body.placed.recorded_digest and body.placed.recorded_digest != body.placed.part.mesh.digest
    ]


def _inside(body: Body, settings: BuildSettings) -> list[Violation]:
    """Return how far a part reaches out of the build volume, or comes too near to walls, lid or plate."""
    least, most = body.mesh.bounds
    size = settings.space.size
    found = []
    if settings.space.shape == "cylinder":
        away = body.mesh.vertices[:, :2] - size[:2] / 2.0
        walls = float(size[0]) / 2.0 - float(np.hypot(away[:, 0], away[:, 1]).max())
    else:
        walls = float(min(least[:2].min(), (size[:2] - most[:2]).min()))
    for name, distance in (("walls", walls), ("lid", float(size[2] - most[2]))):
        if distance < -TOLERANCE:
            message = f"it reaches {-distance:.4g} mm through the {name} of the build volume"
            found.append(Violation("inside build volume", body.label, message))
        elif distance < body.clearance - TOLERANCE:
            message = f"it is {distance:.4g} mm from the {name}, needs {body.clearance:g} mm"
            found.append(Violation("clearance", body.label, message))
    if least[2] < -TOLERANCE:
        message = f"it reaches {-least[2]:.4g} mm below the plate"
        found.append(Violation("inside build volume", body.label, message))
    elif least[2] < body.lift - TOLERANCE:
        found.append(
            Violation("lift", body.label, f"it is {least[2]:.4g} mm above the plate, needs {body.lift:g} mm")
        )
    return found


def _zones(bodies: Sequence[Body], settings: BuildSettings) -> list[Violation]:
    """Return the parts that reach into a forbidden zone."""
    found = []
    for number, (lo, hi) in enumerate(
        zip(settings.space.zone_lo, settings.space.zone_hi, strict=True), start=1
    ):
        for body in bodies:
            least, most = body.mesh.bounds
            if (least >= hi - TOLERANCE).any() or (most <= lo + TOLERANCE).any():
                continue
            zone = box_solids(lo[None], hi[None])
            depth = (
                -solid_distance(body.solid, zone, 0.0)
                if body.is_solid
                else -triangle_distance(body.corners, _faces(zone), 0.0)
            )
            if depth > TOLERANCE or (not body.is_solid and _any_inside(body, lo, hi)):
                message = f"it reaches into forbidden zone {number}"
                found.append(Violation("outside forbidden zones", body.label, message))
    return found


def _faces(solid: "Manifold") -> Floats:
    """Return the corners ``(m, 3, 3)`` of a solid's triangles."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3][mesh.tri_verts.astype(np.int64)])


def _any_inside(body: Body, lo: Floats, hi: Floats) -> bool:
    """Return whether a corner of a surface lies inside a box."""
    vertices = body.mesh.vertices
    return bool(((vertices > lo + TOLERANCE) & (vertices < hi - TOLERANCE)).all(axis=1).any())


def _apart(bodies: Sequence[Body], stop: Stop) -> list[Violation]:
    """Return the pairs that overlap or are nearer than their clearance."""
    if not bodies:
        return []
    lo, hi = (np.array([body.mesh.bounds[side] for body in bodies]) for side in (0, 1))
    greatest = max(body.clearance for body in bodies)
    found: list[Violation] = []
    pairs = near_pairs(lo, hi, greatest - TOLERANCE)
    for done, (i, j) in enumerate(pairs):
        if stop():
            message = f"stopped ({stop.reason}) after {done} of {len(pairs)} near pairs; the rest is unknown"
            return [*found, Violation("clearance", "build", message)]
        one, other = bodies[i], bodies[j]
        needed = max(one.clearance, other.clearance)
        gap = one.gap(other, needed)
        if gap < -TOLERANCE:
            found.append(
                Violation("no intersection", one.label, f"it overlaps {other.label}, {-gap:.4g} mm deep")
            )
        elif gap < needed - TOLERANCE:
            message = f"it is {max(gap, 0.0):.4g} mm from {other.label}, needs {needed:g} mm"
            found.append(Violation("clearance", one.label, message))
    return found
