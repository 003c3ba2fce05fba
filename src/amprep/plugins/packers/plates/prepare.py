"""Compute the outlines and shapes of a packing problem for plates."""

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.boxes.build_space import Space, find_feasible_position, rotated_boxes
from amprep.geometry.no_fit.circle import Circle, find_inside_circle
from amprep.geometry.plates.areas import needed_area
from amprep.geometry.plates.outline import ShadowOutline, outline_of, rectangle
from amprep.geometry.plates.shadow import SEGMENTS, shadow_of
from amprep.kernels.guided_search import EVERYWHERE
from amprep.measures.bounding_volume import points_of
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.control import Stop
from amprep.model.packing import Item, PackingProblem, require_values
from amprep.model.rotations import turns_about_z
from amprep.plugins.packers.instance.prepare import empty_space
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates.shapes import LeastNeed, PlateInstance, PlateObstacle, ShadowShape, turned

if TYPE_CHECKING:
    from manifold3d import CrossSection

SAME = 1e-6
"""Difference of matrix entries, and of points (mm), up to which they are the same."""

ON_PLATE, HANGING = 0.05, 1.0
"""Height (mm) of faces that lie on the plate, and area (mm2) beside them above which a volume hangs over."""

NOWHERE = np.full(2, np.nan)
"""Position of a shape that fits no build."""


class TypeRange(NamedTuple):
    """Range of the shapes of a type of items, and what such an item needs."""

    first: int
    end: int
    need: LeastNeed


def prepare_plates(problem: PackingProblem, params: PlatesParams, stop: Stop) -> PlateInstance | None:
    """Return the outlines and shapes of a problem, which copies share; None after a stop."""
    require_values(problem)
    known: dict[tuple[int, str, bytes], TypeRange] = {}
    outlines: list[ShadowOutline] = []
    shapes: list[ShadowShape] = []
    rows = []
    for item in problem.items:
        key = id(item.volume), item.orientations.freedom, item.orientations.matrices.tobytes()
        if key not in known:
            if stop():
                return None
            known[key] = _add_type(problem, params, item, outlines, shapes)
        rows.append(known[key])
    fits = np.array([any(shape.fits for shape in shapes[r.first : r.end]) for r in rows], bool)
    alone = np.array([any(shape.fits_alone for shape in shapes[r.first : r.end]) for r in rows], bool)
    loose = np.ones(len(rows), bool)
    loose[[placement.item for placement in problem.fixed]] = False
    obstacles = _obstacles(problem, params, outlines)
    number = _by_area(outlines, last=bool(empty_space(problem).radius))
    return PlateInstance(
        problem,
        tuple(outlines[k] for k in np.argsort(number).tolist()),
        tuple(replace(shape, outline=int(number[shape.outline])) for shape in shapes),
        tuple(obstacle._replace(outline=int(number[obstacle.outline])) for obstacle in obstacles),
        np.array([row.first for row in rows], np.int64),
        np.array([row.end for row in rows], np.int64),
        loose & fits,
        loose & ~fits & alone,
        loose & ~fits & ~alone,
        tuple(row.need for row in rows),
    )


def with_lowest_shapes(instance: PlateInstance) -> PlateInstance:
    """Return the instance without shapes that are higher than one plate with all items has to be."""
    counted = np.flatnonzero(instance.free | instance.alone).tolist()
    limit = max((instance.needs[item].height for item in counted), default=0.0) + SAME
    kept = np.array([shape.height <= limit for shape in instance.shapes], bool)
    number = np.concatenate(([0], np.cumsum(kept)))
    if (number[instance.end] == number[instance.first])[instance.free].any():
        return instance
    shapes = tuple(shape for shape, low in zip(instance.shapes, kept.tolist(), strict=True) if low)
    return replace(instance, shapes=shapes, first=number[instance.first], end=number[instance.end])


def _by_area(outlines: list[ShadowOutline], *, last: bool) -> Int64s:
    """Return the number of each outline in the order of increasing area; with `last`, the last one stays so."""
    areas = np.array([outline.area for outline in outlines])
    if last:
        areas[-1] = np.inf
    number = np.empty(len(areas), np.int64)
    number[np.argsort(areas, kind="stable")] = np.arange(len(areas))
    return number


def allowed_rotations(item: Item, step_deg: float) -> Floats:
    """Return the rotations ``(k, 3, 3)`` that are tried: a list, or all turns about z by multiples of a step."""
    if item.orientations.freedom == "list":
        return item.orientations.matrices
    return turns_about_z(np.arange(0.0, 360.0 - 1e-9, step_deg))


def _add_type(
    problem: PackingProblem,
    params: PlatesParams,
    item: Item,
    outlines: list[ShadowOutline],
    shapes: list[ShadowShape],
) -> TypeRange:
    """Add the outlines and the different shapes of an item; those that fit no build only if there are no others."""
    needs, found = [], []
    seen: set[bytes] = set()
    left = list(allowed_rotations(item, params.angle_step_deg))
    while left:
        base = left[0]
        group = [(rotation, _quarters(base, rotation)) for rotation in left]
        left = [rotation for rotation, quarter in group if quarter < 0]
        region, low, high = volume_shadow(item.volume, base)
        wide = _with_margin(params, item.volume, base, (region, low, high))
        outline = outline_of(*wide, problem.clearance, params.tolerance)
        needs.append(LeastNeed(needed_area(region, problem.clearance), float(high[2] - low[2])))
        for rotation, quarter in group:
            if quarter >= 0 and (key := _digest(outline, quarter, high[2] - low[2])) not in seen:
                seen.add(key)
                found.append(_shape(problem, item, rotation, len(outlines), quarter, outline, (low, high)))
        outlines.append(outline)
    kept = [shape for shape in found if shape.fits] or [shape for shape in found if shape.fits_alone] or found
    shapes += kept
    need = LeastNeed(min(need.area for need in needs), min(need.height for need in needs))
    return TypeRange(len(shapes) - len(kept), len(shapes), need)


def _quarters(base: Floats, rotation: Floats) -> int:
    """Return after how many quarter turns about z a rotation is another one; -1 if it never is."""
    turn = base
    for quarter in range(4):
        if np.abs(turn - rotation).max() < SAME:
            return quarter
        turn = np.vstack((-turn[1], turn[0], turn[2]))
    return -1


def _digest(outline: ShadowOutline, quarter: int, height: float) -> bytes:
    """Return a key that is equal for equal shapes."""
    loops = [np.round(turned(loop, quarter) / SAME).astype(np.int64) for loop in outline.loops]
    points = np.unique(np.concatenate(loops), axis=0)
    return points.tobytes() + round(height / SAME).to_bytes(8, "little")


def volume_shadow(volume: BoundingVolume, rotation: Floats) -> tuple["CrossSection", Floats, Floats]:
    """Return the shadow of a turned volume, and the corners ``(3,)`` mm of its enclosing box."""
    from manifold3d import CrossSection, OpType

    points = points_of(volume) @ rotation.T
    low, high = points.min(axis=0), points.max(axis=0)
    if isinstance(volume, Boxes):
        bodies = list(points.reshape(-1, 8, 3))
    elif isinstance(volume, ConvexPieces):
        bodies = [piece.vertices @ rotation.T for piece in volume.pieces]
    else:
        return shadow_of(points, volume.mesh.triangles), low, high
    hulls = [CrossSection.hull_points(body[:, :2]) for body in bodies]
    return CrossSection.batch_boolean(hulls, OpType.Add), low, high


def _with_margin(
    params: PlatesParams,
    volume: BoundingVolume,
    rotation: Floats,
    shadow: tuple["CrossSection", Floats, Floats],
) -> tuple["CrossSection", Floats, Floats]:
    """Return a shadow and the corners ``(2,)`` of its box, with the margin for supports if the volume hangs over."""
    from manifold3d import JoinType

    (region, low, high), margin = shadow, params.support_margin_mm
    if margin > 0.0 and hangs_over(volume, rotation, region):
        wider = region.offset(margin, JoinType.Round, 2.0, SEGMENTS)
        return wider, low[:2] - margin, high[:2] + margin
    return region, low[:2], high[:2]


def hangs_over(volume: BoundingVolume, rotation: Floats, shadow: "CrossSection") -> bool:
    """Tell whether a turned volume covers more of the plate than its lowest faces and pieces."""
    from manifold3d import CrossSection

    points = points_of(volume) @ rotation.T
    lowest = points[:, 2] <= points[:, 2].min() + ON_PLATE
    if isinstance(volume, Solid):
        flat = lowest[volume.mesh.triangles].all(axis=1)
        base = shadow_of(points, volume.mesh.triangles[flat]) if flat.any() else CrossSection()
    elif isinstance(volume, Boxes):
        low = lowest.reshape(-1, 8).any(axis=1)
        base = volume_shadow(Boxes(volume.lo[low], volume.hi[low]), rotation)[0]
    else:
        return True
    return bool((shadow - base).area() > HANGING)


def _shape(
    problem: PackingProblem,
    item: Item,
    rotation: Floats,
    number: int,
    quarter: int,
    outline: ShadowOutline,
    box: tuple[Floats, Floats],
) -> ShadowShape:
    low, high = box
    centre = turned((low + high)[None, :2] / 2.0, quarter)[0]
    half = outline.half[::-1] if quarter % 2 else outline.half
    height = float(high[2] - low[2])
    alone, beside = _positions_alone(problem, item, rotation, outline, quarter, height)
    shift = np.array([*(-centre), -low[2]])
    return ShadowShape(rotation, number, quarter, half, height, shift, alone, beside)


def _positions_alone(
    problem: PackingProblem, item: Item, rotation: Floats, outline: ShadowOutline, quarter: int, height: float
) -> tuple[Floats, Floats]:
    """Return a position in an empty build for the shadow at all heights, and one for the volume itself, or NaN.

    The search is exact for boxes that stay parallel to the axes. For other shapes it is on the boxes around their
    convex pieces, and exact on a round plate without zones.
    """
    space = empty_space(problem)
    own = 2.0 * outline.half if quarter % 2 == 0 else 2.0 * outline.half[::-1]
    if isinstance(item.volume, Boxes) and (own <= _plan_size(item.volume, rotation) + SAME).all():
        lo, hi = rotated_boxes(item.volume.lo, item.volume.hi, rotation)
        middle = (lo.min(axis=0) + hi.max(axis=0)) / 2.0
        lo, hi = lo - [*middle[:2], lo[:, 2].min()], hi - [*middle[:2], lo[:, 2].min()]
    else:
        pieces = [turned(piece, quarter) for piece in outline.pieces]
        lo = np.array([[*piece.min(axis=0), 0.0] for piece in pieces])
        hi = np.array([[*piece.max(axis=0), height] for piece in pieces])
    tall_lo, tall_hi = lo.copy(), hi.copy()
    tall_lo[:, 2], tall_hi[:, 2] = 0.0, hi[:, 2].max()
    found = find_feasible_position(tall_lo, tall_hi, space)
    if found is None:
        found = _inside_circle(outline, quarter, height, space)
    if found is not None:
        return found[:2], NOWHERE
    found = find_feasible_position(lo, hi, space)
    return NOWHERE, NOWHERE if found is None else found[:2]


def _plan_size(volume: Boxes, rotation: Floats) -> Floats:
    """Return the size ``(2,)`` mm in plan of the box around turned boxes."""
    lo, hi = rotated_boxes(volume.lo, volume.hi, rotation)
    return np.asarray((hi.max(axis=0) - lo.min(axis=0))[:2])


def _inside_circle(outline: ShadowOutline, quarter: int, height: float, space: Space) -> Floats | None:
    """Return a position on a round plate without zones; None elsewhere or if there is none."""
    if not space.radius or len(space.zone_lo) or height > space.hi[2] - space.lo[2] + space.slack:
        return None
    circle = Circle(space.axis, space.radius)
    return find_inside_circle(turned(outline.hull, quarter), circle, space.slack)


def _obstacles(
    problem: PackingProblem, params: PlatesParams, outlines: list[ShadowOutline]
) -> list[PlateObstacle]:
    """Return the forbidden zones, the fixed items, and the edge of a round plate; add their outlines."""
    space, found = empty_space(problem), []

    def add(
        outline: ShadowOutline, position: Floats, plate: int, clearance: float, low: float, high: float
    ) -> None:
        found.append(PlateObstacle(len(outlines), position, plate, clearance, low, high))
        outlines.append(outline)

    for lo, hi in zip(problem.space.zone_lo, problem.space.zone_hi, strict=True):
        low, high = np.maximum(lo[:2], -1.0), np.minimum(hi[:2], problem.space.size[:2] + 1.0)
        if (hi > lo).all() and (high > low).all():
            add(rectangle(low, high), (low + high) / 2.0, EVERYWHERE, 0.0, float(lo[2]), float(hi[2]))
    for fixed in problem.fixed:
        volume = problem.items[fixed.item].volume
        region, low, high = volume_shadow(volume, fixed.rotation)
        wide = _with_margin(params, volume, fixed.rotation, (region, low, high))
        outline = outline_of(*wide, problem.clearance, params.tolerance)
        middle = (low + high)[:2] / 2.0 + fixed.translation[:2]
        add(outline, middle, 0, problem.clearance, -np.inf, np.inf)
    if space.radius:
        edge = rectangle(np.full(2, -space.radius), np.full(2, space.radius))
        add(edge, space.axis, EVERYWHERE, 0.0, -np.inf, np.inf)
    return found
