"""Check the packer's promise on the meshes: parts are inside, apart, outside zones and placed as allowed."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.checks.packing.motion import motion_fault
from amprep.checks.packing.pairs import PairCounts, PlacedBody, judge_pairs
from amprep.checks.packing.walls import wall_distances
from amprep.checks.violation import Violation
from amprep.geometry.meshes.box_tree import BoxTree, box_tree
from amprep.geometry.meshes.distance import box_solids, near_pairs, solid_distance, triangle_distance
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.build import BuildSettings, PlacedPart
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import Manifold

ROUNDING = 1e-4
"""Largest movement of a point (mm) by rounding in a build file; added to `CONTACT_TOLERANCE`."""

TOLERANCE = CONTACT_TOLERANCE + ROUNDING


class CheckedMesh:
    """The mesh of a part with what all its copies share; each is made when it is first needed."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh

    @cached_property
    def tree(self) -> BoxTree:
        """The tree of its triangles."""
        return box_tree(*self.mesh.arrays)

    @cached_property
    def solid(self) -> "Manifold":
        """The mesh as a solid, in part coordinates."""
        return as_manifold(self.mesh.vertices, self.mesh.triangles)


class CheckedPart:
    """A placed part in build coordinates."""

    def __init__(self, placed: PlacedPart, settings: BuildSettings, shared: CheckedMesh) -> None:
        self.placed = placed
        self.label = placed.label
        self.is_solid = placed.part.is_solid
        self.shared = shared
        own = placed.part.overrides
        self.clearance = settings.clearance if own.clearance_mm is None else own.clearance_mm
        self.lift = settings.lift if own.lift_mm is None else own.lift_mm

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh in build coordinates."""
        return self.placed.mesh

    @cached_property
    def body(self) -> PlacedBody:
        """The part as the judge of distances needs it."""
        return PlacedBody(
            self.mesh.vertices, lambda: self.shared.tree, (lambda: self.solid) if self.is_solid else None
        )

    @cached_property
    def solid(self) -> "Manifold":
        """The mesh in build coordinates as a solid."""
        return self.shared.solid.transform(self.placed.matrix[:3])

    @property
    def corners(self) -> Floats:
        """The corners ``(m, 3, 3)`` of the triangles (mm)."""
        return np.asarray(self.mesh.vertices[self.mesh.triangles])


def check_placed(parts: Sequence[PlacedPart], settings: BuildSettings, stop: Stop) -> list[Violation]:
    """Return the violations of the packer's promise in a build; see `judge_placed`."""
    return judge_placed(parts, settings, stop)[0]


def judge_placed(
    parts: Sequence[PlacedPart], settings: BuildSettings, stop: Stop
) -> tuple[list[Violation], PairCounts]:
    """Return the violations of the packer's promise in a build, and how many pairs were judged by which method.

    The clearance and lift of a part override those of the build; between two parts the greater clearance
    applies. The check is exact on the meshes: distances are those of triangles, and solids that meet or contain
    each other are intersected by manifold3d. An overlap of at most `CONTACT_TOLERANCE` is contact.

    Parameters
    ----------
    parts
        The placed parts of one build.
    settings
        Build volume, clearance and lift.
    stop
        Asked before each pair of parts. After a stop, a violation says that the rest is unknown.
    """
    meshes = {id(placed.part.mesh): CheckedMesh(placed.part.mesh) for placed in parts}
    checked = [CheckedPart(placed, settings, meshes[id(placed.part.mesh)]) for placed in parts]
    found = [*_moved(checked), *_unchanged(checked)]
    checked = [part for part in checked if np.isfinite(part.mesh.vertices).all() and len(part.mesh.triangles)]
    found += [violation for part in checked for violation in _inside(part, settings)]
    found += _zones(checked, settings)
    close, counts = _apart(checked, stop)
    return [*found, *close], counts


def _moved(checked: Sequence[CheckedPart]) -> list[Violation]:
    """Return the placements that are not allowed."""
    found = []
    for part in checked:
        matrix = part.placed.matrix
        fault = motion_fault(matrix[:3, :3], part.placed.orientations)
        if not np.isfinite(matrix).all() or (matrix[3] != [0.0, 0.0, 0.0, 1.0]).any():
            fault = "is not a rigid motion"
        if fault:
            found.append(Violation("allowed motion", part.label, f"its placement {fault}"))
    return found


def _unchanged(checked: Sequence[CheckedPart]) -> list[Violation]:
    """Return the parts whose geometry differs from the digest in the build file, or that are not where it says."""
    moved = [
        Violation(
            "part unchanged",
            part.label,
            f"it is {part.placed.moved_mm:.4g} mm from the position that the build file recorded",
        )
        for part in checked
        if not part.placed.moved_mm <= TOLERANCE
    ]
    return moved + [
        Violation(
            "part unchanged", part.label, "its geometry differs from what the build file recorded (SHA-256)"
        )
        for part in checked
        if part.placed.recorded_digest and part.placed.recorded_digest != part.placed.part.mesh.digest
    ]


def _inside(part: CheckedPart, settings: BuildSettings) -> list[Violation]:
    """Return where a part leaves the build volume or is too close to its walls, its top or the plate."""
    found = []
    for name, distance in wall_distances(part.mesh.vertices, settings.space).items():
        if distance < -TOLERANCE:
            message = f"it extends {-distance:.4g} mm beyond the {name} of the build volume"
            found.append(Violation("inside build volume", part.label, message))
        elif distance < part.clearance - TOLERANCE:
            message = (
                f"it is {max(distance, 0.0):.4g} mm from the {name}, expected at least {part.clearance:g} mm"
            )
            found.append(Violation("clearance", part.label, message))
    lowest = part.mesh.bounds[0][2]
    if lowest < -TOLERANCE:
        message = f"it extends {-lowest:.4g} mm below the plate"
        found.append(Violation("inside build volume", part.label, message))
    elif lowest < part.lift - TOLERANCE:
        found.append(
            Violation(
                "lift",
                part.label,
                f"it is {lowest:.4g} mm above the plate, expected at least {part.lift:g} mm",
            )
        )
    return found


def _zones(checked: Sequence[CheckedPart], settings: BuildSettings) -> list[Violation]:
    """Return the parts that overlap a forbidden zone."""
    found = []
    for number, (lo, hi) in enumerate(
        zip(settings.space.zone_lo, settings.space.zone_hi, strict=True), start=1
    ):
        for part in checked:
            least, most = part.mesh.bounds
            if (least >= hi - TOLERANCE).any() or (most <= lo + TOLERANCE).any():
                continue
            zone = box_solids(lo[None], hi[None])
            depth = (
                -solid_distance(part.solid, zone, 0.0)
                if part.is_solid
                else -triangle_distance(part.corners, _faces(zone), 0.0)
            )
            if depth > TOLERANCE or (not part.is_solid and _any_inside(part, lo, hi)):
                message = f"it overlaps forbidden zone {number}"
                found.append(Violation("outside forbidden zones", part.label, message))
    return found


def _faces(solid: "Manifold") -> Floats:
    """Return the corners ``(m, 3, 3)`` of a solid's triangles."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3][mesh.tri_verts.astype(np.int64)])


def _any_inside(part: CheckedPart, lo: Floats, hi: Floats) -> bool:
    """Return whether a vertex of a surface is inside a box."""
    vertices = part.mesh.vertices
    return bool(((vertices > lo + TOLERANCE) & (vertices < hi - TOLERANCE)).all(axis=1).any())


def _apart(checked: Sequence[CheckedPart], stop: Stop) -> tuple[list[Violation], PairCounts]:
    """Return the pairs of parts that overlap or are closer than their clearance, and how the pairs were judged."""
    if not checked:
        return [], PairCounts()
    lo, hi = (np.array([part.mesh.bounds[side] for part in checked]) for side in (0, 1))
    clearance = np.array([part.clearance for part in checked])
    pairs = near_pairs(lo, hi, float(clearance.max()) - TOLERANCE)
    needed = np.array([max(clearance[i], clearance[j]) for i, j in pairs])
    judged = judge_pairs([part.body for part in checked], pairs, needed, TOLERANCE, stop)
    found = [_fault(checked[i], checked[j], gap) for i, j, gap in judged.close]
    if judged.left:
        message = (
            f"stopped ({stop.reason}) after {len(pairs) - judged.left} of {len(pairs)} pairs of parts; "
            "the rest was not checked"
        )
        found.append(Violation("clearance", "build", message))
    apart = len(checked) * (len(checked) - 1) // 2 - len(pairs)
    return found, judged.counts + PairCounts(boxes=apart)


def _fault(one: CheckedPart, other: CheckedPart, gap: float) -> Violation:
    """Describe a pair of parts whose distance is too small."""
    if gap < -TOLERANCE:
        return Violation("no intersection", one.label, f"it overlaps {other.label} by {-gap:.4g} mm")
    needed = max(one.clearance, other.clearance)
    message = f"it is {max(gap, 0.0):.4g} mm from {other.label}, expected at least {needed:g} mm"
    return Violation("clearance", one.label, message)
