"""Bounds on packings of true shapes: volume, plate area without stacking, and the highest shape.

All bounds are valid for every packing that the judge accepts. Distances are Euclidean, and contacts may be penetrated
by `CONTACT_TOLERANCE`: shapes count smaller by it, and the build volume larger.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.geometry.meshes.distance import box_solids, convex_solid
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.measures.bounding_volume import points_of, volume_of
from amprep.measures.objective import greatest_height
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.build_volume import BuildVolume
from amprep.model.packing import Item, PackingProblem

if TYPE_CHECKING:
    from manifold3d import Manifold

CIRCULAR_SEGMENTS = 64
"""Corners of a full circle in outlines that are grown; they lie on the circle, so that areas are never too large."""

ROUNDING = 1e-9
"""Fraction of a build by which sums may exceed it for rounding."""

# Strategy. Grown by half the clearance, shapes are disjoint, and inside the build volume less half the clearance. So
# are their shadows on the plate, where nothing may be above another. The volume of a grown shape is at least that of a
# ball of the same volume, grown as much (Brunn and Minkowski); the area of a grown shadow is computed. A shape counts
# with the least area over its orientations, and with the least height over those in which it is not too wide.


@dataclass(frozen=True)
class ShapeExtents:
    """What a shape takes at least of a build: volume (mm3), area of the plate (mm2), and height (mm), grown or not.

    Attributes
    ----------
    volume, area
        With half the clearance around the shape. The area is 0 if it was not computed.
    height
        Without clearance; 0 for a shape that may be turned in any way.
    """

    volume: float
    area: float
    height: float


def parts_bound(problem: PackingProblem, without: Collection[int] = ()) -> float:
    """Return a bound on the objective for the volumes of the items as they are, in all their orientations.

    Fixed items are not judged: they take no room here, since they may overlap or be outside the build volume.

    Parameters
    ----------
    problem
        Problem with any volumes, for example the meshes of the parts.
    without
        Items that do not count since they have no place: in a problem of builds or height they are too large.

    Returns
    -------
    float
        The least number of builds, the greatest value of one build, or the least height (mm).
    """
    fixed = {placement.item for placement in problem.fixed}
    left_out = fixed.union(without)
    counted = [number for number in range(len(problem.items)) if number not in left_out]
    known: dict[tuple[int, int], ShapeExtents] = {}
    extents = []
    for number in counted:
        item = problem.items[number]
        key = id(item.volume), id(item.orientations)
        if key not in known:
            known[key] = shape_extents(item, problem)
        extents.append(known[key])
    if problem.objective == "height":
        return _least_height(problem, extents)
    taken, room = _taken_of_room(problem, extents)
    if problem.objective == "fill":
        aside = float(sum(problem.items[number].value for number in fixed))
        return aside + min(
            _most_value(problem, counted, each / of) for each, of in zip(taken, room, strict=True)
        )
    needed = (int(np.ceil(each.sum() / of - ROUNDING)) for each, of in zip(taken, room, strict=True))
    return float(max(1 if counted or fixed else 0, *needed))


def shape_extents(item: Item, problem: PackingProblem) -> ShapeExtents:
    """Return what the shape of an item takes at least."""
    radius = (problem.clearance - CONTACT_TOLERANCE) / 2.0
    lo, hi = item.volume.enclosing()
    layer = 2.0 * CONTACT_TOLERANCE * float((np.roll(hi - lo, 1) * (hi - lo)).sum())
    volume = max(volume_of(item.volume) - layer, 0.0)
    grown = (np.cbrt(volume) + max(radius, 0.0) * np.cbrt(4.0 * np.pi / 3.0)) ** 3
    area = 0.0 if problem.stacking else _least_shadow(item, radius)
    return ShapeExtents(float(grown), area, _least_extent(item, problem))


def shadow_area(volume: BoundingVolume, rotation: Floats, radius: float) -> float:
    """Return the area (mm2) of the shadow of a volume on the plate, holes left out, grown by a radius (mm).

    Where the volume is no valid solid the area is 0.
    """
    from manifold3d import JoinType

    solid = _solid(volume)
    if not accepted(solid):
        return 0.0
    turned = solid.transform(np.column_stack((rotation, np.zeros(3))))
    return float(turned.project().offset(radius, JoinType.Round, 2.0, CIRCULAR_SEGMENTS).area())


def _solid(volume: BoundingVolume) -> "Manifold":
    """Return the volume as a solid."""
    from manifold3d import Manifold, OpType

    if isinstance(volume, Boxes):
        return box_solids(volume.lo, volume.hi)
    if isinstance(volume, ConvexPieces):
        return Manifold.batch_boolean([convex_solid(piece.vertices) for piece in volume.pieces], OpType.Add)
    return as_manifold(*volume.mesh.arrays)


def _least_shadow(item: Item, radius: float) -> float:
    """Return the least area (mm2) of the grown shadow; 0 for an item that may be turned in any way."""
    allowed = item.orientations
    if allowed.freedom == "free":
        return 0.0
    rotations = allowed.matrices if allowed.freedom == "list" else np.eye(3)[None]
    upright = {tuple(np.round(np.abs(rotation[2]), 9)): rotation for rotation in rotations}
    return min(shadow_area(item.volume, rotation, radius) for rotation in upright.values())


def _least_extent(item: Item, problem: PackingProblem) -> float:
    """Return the least height (mm) over the orientations; 0 for an item that may be turned in any way.

    Orientations in which the item is wider than the build volume do not count, if there are others.
    """
    allowed = item.orientations
    if allowed.freedom == "free":
        return 0.0
    points = points_of(item.volume)
    rotations = allowed.matrices if allowed.freedom == "list" else np.eye(3)[None]
    heights = np.ptp(points @ rotations[:, 2].T, axis=0)
    widest = problem.space.size[:2] - 2.0 * problem.clearance + 2.0 * CONTACT_TOLERANCE
    for number in np.argsort(heights, kind="stable").tolist():
        if (np.ptp(points @ rotations[number, :2].T, axis=0) <= widest).all():
            return float(heights[number])
    return float(heights.min())


def _taken_of_room(problem: PackingProblem, extents: list[ShapeExtents]) -> tuple[list[Floats], list[float]]:
    """Return volumes and areas of the shapes, and the volume and area of a build."""
    base = _base_area(problem.space, problem.clearance)
    high = float(problem.space.size[2]) - problem.lift + 2.0 * CONTACT_TOLERANCE
    volumes = np.array([each.volume for each in extents])
    areas = np.maximum([each.area for each in extents], volumes / max(high, 1e-12))
    if problem.stacking:
        return [volumes], [base * high]
    return [volumes, areas], [base * high, base]


def _base_area(space: BuildVolume, clearance: float) -> float:
    """Return the area (mm2) that grown shapes share."""
    side = np.maximum(space.size[:2] - clearance + 2.0 * CONTACT_TOLERANCE, 1e-6)
    return float(side.prod() * (np.pi / 4.0 if space.shape == "cylinder" else 1.0))


def _least_height(problem: PackingProblem, extents: list[ShapeExtents]) -> float:
    """Return the least height (mm) by fixed items, the highest shape, and volume."""
    highest = max(problem.lift + each.height for each in extents) if extents else 0.0
    highest = max(highest, greatest_height(problem, problem.fixed))
    if not extents:
        return highest
    filled = sum(each.volume for each in extents) / _base_area(problem.space, problem.clearance)
    return max(highest, filled + problem.lift - problem.clearance - 2.0 * CONTACT_TOLERANCE)


def _most_value(problem: PackingProblem, counted: list[int], fraction: Floats) -> float:
    """Return the value of a fractional knapsack: what one build holds of items that take fractions of it."""
    value = np.array([problem.items[number].value for number in counted])
    order = np.argsort(-value / np.maximum(fraction, 1e-15), kind="stable")
    before = np.concatenate(([0.0], np.cumsum(fraction[order])[:-1]))
    part = np.clip((1.0 - before) / np.maximum(fraction[order], 1e-15), 0.0, 1.0)
    most = float((part * value[order]).sum() * (1.0 + ROUNDING))
    return min(most, float(value.sum()))
