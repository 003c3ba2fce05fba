"""Check the packer's promise on the bounding volumes."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats, Int64s
from amprep.checks.packing.motion import motion_fault
from amprep.checks.packing.pairs import CloseBodies, PlacedBody, judge_pairs
from amprep.checks.packing.walls import wall_distances
from amprep.checks.violation import Violation
from amprep.geometry.boxes.build_space import Space, find_feasible_position, rotated_boxes
from amprep.geometry.meshes.box_tree import BoxTree, box_tree
from amprep.geometry.meshes.distance import box_distance, box_solids, convex_solid, near_pairs, solid_distance
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.control import Stop
from amprep.model.counting import counted
from amprep.model.mesh import join_meshes
from amprep.model.packing import Packing, PackingProblem, Placement

if TYPE_CHECKING:
    from manifold3d import Manifold

TOLERANCE = CONTACT_TOLERANCE * (1.0 + 1e-5)

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=bool)

_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 4, 5], [0, 5, 1]]
    + [[2, 7, 6], [2, 3, 7], [0, 2, 6], [0, 6, 4], [1, 7, 3], [1, 5, 7]]
)
"""The triangles of a box on `_CORNERS`, outward oriented."""


@dataclass(frozen=True, eq=False)
class PlacedVolume:
    """The bounding volume of a placed item."""

    problem: PackingProblem
    placement: Placement
    fixed: bool

    @property
    def label(self) -> str:
        """The item's name in messages."""
        item = self.problem.items[self.placement.item]
        return f"item {self.placement.item} (part {item.part}, copy {item.copy})"

    @cached_property
    def boxes(self) -> tuple[Floats, Floats] | None:
        """Corners ``(k, 3)`` of its boxes; None if it is not made of boxes parallel to the axes."""
        volume, turned = self.problem.items[self.placement.item].volume, np.abs(self.placement.rotation)
        if not isinstance(volume, Boxes) or (np.minimum(turned, np.abs(1.0 - turned)) > 1e-9).any():
            return None
        lo, hi = rotated_boxes(volume.lo, volume.hi, self.placement.rotation)
        return lo + self.placement.translation, hi + self.placement.translation

    @cached_property
    def hulls(self) -> list[Floats]:
        """Points ``(n, 3)`` of each piece. A piece is the convex hull of its points, except in a `Solid`."""
        volume = self.problem.items[self.placement.item].volume
        if isinstance(volume, Boxes):
            pieces = [np.where(_CORNERS, hi, lo) for lo, hi in zip(volume.lo, volume.hi, strict=True)]
        elif isinstance(volume, ConvexPieces):
            pieces = [piece.vertices for piece in volume.pieces]
        else:
            pieces = [volume.mesh.vertices]
        return [piece @ self.placement.rotation.T + self.placement.translation for piece in pieces]

    @cached_property
    def points(self) -> Floats:
        """The points ``(n, 3)`` of all pieces."""
        return np.concatenate(self.hulls)

    @cached_property
    def solid(self) -> "Manifold":
        """The volume as a solid."""
        from manifold3d import Manifold, OpType

        volume = self.problem.items[self.placement.item].volume
        if isinstance(volume, Boxes | ConvexPieces):
            return Manifold.batch_boolean([convex_solid(hull) for hull in self.hulls], OpType.Add)
        return as_manifold(self.points, volume.mesh.triangles)

    def gap(self, other: "PlacedVolume", limit: float) -> float:
        """Return the distance to another volume (mm), at most about `limit`; negative if they overlap."""
        if self.boxes is not None and other.boxes is not None:
            return box_distance(*self.boxes, *other.boxes)
        return solid_distance(self.solid, other.solid, limit)

    def body(self, trees: dict[int, BoxTree]) -> PlacedBody:
        """Return the volume as the judge of distances needs it; `trees` are by the identity of the volumes."""
        return PlacedBody(self.points, lambda: self._tree(trees), lambda: self.solid)

    def _tree(self, trees: dict[int, BoxTree]) -> BoxTree:
        volume = self.problem.items[self.placement.item].volume
        if id(volume) not in trees:
            trees[id(volume)] = box_tree(self.points, _triangles(volume))
        return trees[id(volume)]


def _triangles(volume: BoundingVolume) -> Int64s:
    """Return the triangles of all pieces, ``(m, 3)``, on the points of `PlacedVolume`."""
    if isinstance(volume, Boxes):
        return np.concatenate([_FACES + 8 * k for k in range(len(volume.lo))])
    if isinstance(volume, ConvexPieces):
        return join_meshes(volume.pieces).triangles.astype(np.int64)
    return volume.mesh.triangles.astype(np.int64)


def check_packing(problem: PackingProblem, packing: Packing) -> list[Violation]:
    """Return the violations of the packer's promise.

    The clearance is the exact distance between volumes; an overlap of at most `CONTACT_TOLERANCE` is contact.
    Fixed placements must be kept and are not checked otherwise. An item of boxes that is unplaced as too large
    must not fit an empty build.
    """
    faults = _each_item_once(problem, packing)
    if any(v.promise == "known item" for v in faults):
        return faults
    faults += [*_fixed_kept(problem, packing), *_reasons(problem, packing), *_claims(problem, packing)]
    for number, build in enumerate(packing.builds):
        fixed = {p.item for p in problem.fixed} if number == 0 else set()
        placed = [PlacedVolume(problem, placement, placement.item in fixed) for placement in build]
        faults += _build_faults(problem, placed)
    return faults


def _each_item_once(problem: PackingProblem, packing: Packing) -> list[Violation]:
    """Return unknown items, items that do not occur exactly once, and empty builds."""
    placed = [placement.item for build in packing.builds for placement in build]
    count = Counter([*placed, *(unplaced.item for unplaced in packing.unplaced)])
    n = len(problem.items)
    faults = [
        Violation("known item", f"item {i}", f"is unknown; items are 0 to {n - 1}")
        for i in sorted(count)
        if not 0 <= i < n
    ]
    faults += [
        Violation(
            "every item once",
            f"item {i}",
            f"occurs {count[i]} times in the builds and the unplaced items, expected once",
        )
        for i in range(n)
        if count[i] != 1
    ]
    for number, build in enumerate(packing.builds, start=1):
        if not build:
            faults.append(Violation("no empty build", f"build {number}", "contains no item"))
    if problem.objective != "builds" and len(packing.builds) > 1:
        faults.append(Violation("one build", "packing", f"has {len(packing.builds)} builds, expected one"))
    return faults


def _fixed_kept(problem: PackingProblem, packing: Packing) -> list[Violation]:
    """Return the fixed placements that the first build does not keep."""
    first = {placement.item: placement for placement in (packing.builds[0] if packing.builds else ())}
    return [
        Violation(
            "fixed placement kept", f"item {fixed.item}", "is not in the first build at its fixed placement"
        )
        for fixed in problem.fixed
        if fixed.item not in first or np.abs(first[fixed.item].matrix - fixed.matrix).max() > 1e-9
    ]


def _build_faults(problem: PackingProblem, placed: Sequence[PlacedVolume]) -> list[Violation]:
    """Return the violations in one build."""
    faults: list[Violation] = []
    for volume in placed:
        orientations = problem.items[volume.placement.item].orientations
        fault = motion_fault(volume.placement.rotation, orientations)
        if not np.isfinite(volume.placement.translation).all():
            fault = "is not finite"
        if fault and not volume.fixed:
            faults.append(Violation("allowed motion", volume.label, f"its placement {fault}"))
    if faults:
        return faults
    for volume in placed:
        if not volume.fixed:
            faults += [*_inside(problem, volume), *_lifted(problem, volume), *_zones(problem, volume)]
    return [*faults, *_apart(problem, placed)]


def _inside(problem: PackingProblem, volume: PlacedVolume) -> list[Violation]:
    """Return where a volume is closer than the clearance to the walls or the top of the build volume."""
    return [
        Violation(
            "inside build volume",
            volume.label,
            f"it is {distance:.6g} mm from the {name}, expected at least {problem.clearance:g} mm",
        )
        for name, distance in wall_distances(volume.points, problem.space).items()
        if distance < problem.clearance - TOLERANCE
    ]


def _lifted(problem: PackingProblem, volume: PlacedVolume) -> list[Violation]:
    """Return a violation if the lowest point is below `lift`, or above it although stacking is off."""
    lowest = float(volume.points[:, 2].min())
    if lowest < problem.lift - TOLERANCE:
        return [
            Violation(
                "lift",
                volume.label,
                f"its lowest point is {lowest:.6g} mm above the plate, expected at least {problem.lift:g} mm",
            )
        ]
    if not problem.stacking and lowest > problem.lift + TOLERANCE:
        message = f"its lowest point is {lowest:.6g} mm above the plate, expected {problem.lift:g} mm without stacking"
        return [Violation("stacking", volume.label, message)]
    return []


def _zones(problem: PackingProblem, volume: PlacedVolume) -> list[Violation]:
    """Return the forbidden zones that a volume overlaps."""
    faults = []
    least, most = volume.points.min(axis=0), volume.points.max(axis=0)
    for number, (lo, hi) in enumerate(
        zip(problem.space.zone_lo, problem.space.zone_hi, strict=True), start=1
    ):
        if (least >= hi - TOLERANCE).any() or (most <= lo + TOLERANCE).any():
            continue
        if volume.boxes is not None:
            gap = box_distance(*volume.boxes, lo[None], hi[None])
        else:
            gap = solid_distance(volume.solid, box_solids(lo[None], hi[None]), 0.0)
        if gap < -TOLERANCE:
            faults.append(
                Violation(
                    "outside forbidden zones",
                    volume.label,
                    f"it overlaps forbidden zone {number} by {-gap:.6g} mm",
                )
            )
    return faults


def _apart(problem: PackingProblem, placed: Sequence[PlacedVolume]) -> list[Violation]:
    """Return the pairs of volumes that are closer than the clearance."""
    if not placed:
        return []
    lo = np.array([volume.points.min(axis=0) for volume in placed])
    hi = np.array([volume.points.max(axis=0) for volume in placed])
    near = near_pairs(lo, hi, problem.clearance - TOLERANCE)
    near = [(i, j) for i, j in near if not (placed[i].fixed and placed[j].fixed)]
    boxed = [(i, j) for i, j in near if placed[i].boxes is not None and placed[j].boxes is not None]
    close = [CloseBodies(i, j, placed[i].gap(placed[j], problem.clearance)) for i, j in boxed]
    trees: dict[int, BoxTree] = {}
    bodies = [volume.body(trees) for volume in placed] if len(boxed) < len(near) else []
    others = sorted(set(near) - set(boxed))
    needed = np.full(len(others), problem.clearance)
    close += judge_pairs(bodies, others, needed, TOLERANCE, Stop()).close
    return [
        _fault(problem, placed[i], placed[j], gap)
        for i, j, gap in sorted(close)
        if gap < problem.clearance - TOLERANCE
    ]


def _fault(problem: PackingProblem, one: PlacedVolume, other: PlacedVolume, gap: float) -> Violation:
    """Describe a pair of volumes whose distance is too small."""
    if gap < 0.0:
        return Violation("no overlap", one.label, f"it overlaps {other.label} by {-gap:.6g} mm")
    message = f"it is {gap:.6g} mm from {other.label}, expected at least {problem.clearance:g} mm"
    return Violation("clearance", one.label, message)


def _reasons(problem: PackingProblem, packing: Packing) -> list[Violation]:
    """Return the unplaced items without a reason, or with a wrong one."""
    faults = []
    for unplaced in packing.unplaced:
        if not unplaced.reason:
            faults.append(
                Violation("reason given", f"item {unplaced.item}", "is unplaced, but no reason is given")
            )
        if (
            unplaced.reason == "too large"
            and 0 <= unplaced.item < len(problem.items)
            and _fits(problem, unplaced.item)
        ):
            faults.append(
                Violation(
                    "reason true",
                    f"item {unplaced.item}",
                    "is reported as too large, but it fits an empty build",
                )
            )
    return faults


def _fits(problem: PackingProblem, index: int) -> bool:
    """Return whether an item of boxes fits an empty build in one of its allowed orientations."""
    item, size, gap = problem.items[index], problem.space.size, problem.clearance
    if not isinstance(item.volume, Boxes) or item.orientations.freedom != "list":
        return False
    radius = float(size[0]) / 2.0 - gap if problem.space.shape == "cylinder" else 0.0
    if problem.space.shape == "cylinder" and radius <= 0.0:
        return False
    zones = problem.space.zone_lo, problem.space.zone_hi
    lo = np.array([gap, gap, problem.lift])
    space = Space(lo, size - gap, size[:2] / 2.0, radius, *zones, not problem.stacking, 0.0)
    turned = (
        rotated_boxes(item.volume.lo, item.volume.hi, rotation) for rotation in item.orientations.matrices
    )
    return any(find_feasible_position(lo, hi, space) is not None for lo, hi in turned)


def _claims(problem: PackingProblem, packing: Packing) -> list[Violation]:
    """Return where the status and the bound contradict the packing or each other."""
    reached, sign = _reached(problem, packing), -1.0 if problem.objective == "fill" else 1.0
    slack = 1e-9 * max(1.0, abs(reached))
    incomplete = problem.objective != "fill" and bool(packing.unplaced)
    faults = []
    if packing.bound is not None and not incomplete and sign * (packing.bound - reached) > slack:
        faults.append(
            Violation(
                "bound", "packing", f"reaches {reached:g}, which is better than its bound {packing.bound:g}"
            )
        )
    if packing.status == "optimal":
        proved = packing.bound is not None and sign * (reached - packing.bound) <= slack
        if incomplete or not proved:
            left = counted(len(packing.unplaced), "item")
            message = (
                f"is reported as optimal, but reaches {reached:g}, bound {packing.bound}, {left} unplaced"
            )
            faults.append(Violation("status", "packing", message))
    if packing.status == "infeasible" and not packing.unplaced:
        faults.append(Violation("status", "packing", "is reported as infeasible, but every item is placed"))
    return faults


def _reached(problem: PackingProblem, packing: Packing) -> float:
    """Return the value of the objective."""
    if problem.objective == "builds":
        return float(len(packing.builds))
    placed = [placement for build in packing.builds for placement in build]
    if problem.objective == "fill":
        return float(sum(problem.items[placement.item].value for placement in placed))
    return max((float(PlacedVolume(problem, p, fixed=False).points[:, 2].max()) for p in placed), default=0.0)
