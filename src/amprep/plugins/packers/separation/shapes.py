"""Prepare a packing problem for the separation search: the shapes of its items and their positions."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s
from amprep.geometry.boxes.build_space import find_feasible_position
from amprep.geometry.no_fit.between_zones import find_between_zones
from amprep.geometry.no_fit.circle import Circle, circle_sides, find_inside_circle, outline_of
from amprep.kernels.no_fit.records import PositionRange
from amprep.measures.bounding_volume import volume_of
from amprep.model.bounding_volume import BoundingVolume
from amprep.model.control import Stop
from amprep.model.packing import Item, PackingProblem, require_values
from amprep.plugins.packers.instance.prepare import empty_space
from amprep.plugins.packers.separation.pieces import PieceSet, decompose_volumes

MOST_SHAPES = 320
"""Number of shapes above which types with several orientations keep only some, those of least height."""

MOST_PIECES, MOST_OF_VOLUME = 2500, 40
"""Number of convex pieces of all volumes together, and for each volume where there are few."""

TIME_FOR_PIECES, SECONDS_A_PIECE = 0.3, 0.005
"""Fraction of a time limit that the decomposition may take, and what a piece takes, s."""

SAME = 1e-6
"""Difference (mm) of points up to which two rotations of a volume are the same shape."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A bounding volume in one orientation, as convex pieces relative to the least corner.

    Attributes
    ----------
    rotation
        ``(3, 3)``.
    pieces
        For each convex piece its points ``(k, 3)`` mm.
    shift
        ``(3,)`` mm from the least corner to the origin of the turned volume.
    feasible_position
        ``(3,)`` mm a position of the least corner in an empty build; NaN when none was found.
    """

    rotation: Floats
    pieces: tuple[Floats, ...]
    shift: Floats
    feasible_position: Floats

    @cached_property
    def size(self) -> Floats:
        """The enclosing box, ``(3,)`` mm."""
        return np.asarray(np.concatenate(self.pieces).max(axis=0))

    @cached_property
    def outline(self) -> Floats:
        """Corners ``(k, 2)`` mm of the convex hull of the projection to the plate."""
        return outline_of(np.concatenate(self.pieces)[:, :2])

    @property
    def fits(self) -> bool:
        """Whether a position in an empty build is known."""
        return bool(np.isfinite(self.feasible_position[0]))


@dataclass(frozen=True, eq=False)
class ShapeInstance:
    """A packing problem prepared for the separation search.

    Attributes
    ----------
    shapes
        The shapes of all item types, those of a type one after another.
    first, end
        ``(n,)`` range of the shapes of each item.
    free
        ``(n,)`` items to be placed, which are neither fixed nor too large.
    too_large
        ``(n,)`` items without a known position in an empty build.
    volumes
        ``(n,)`` mm3.
    pieces
        For each item the convex pieces of its volume, not turned.
    excess
        ``(n,)`` total volume of these pieces over that of the volume, less 1.
    """

    problem: PackingProblem
    shapes: tuple[Shape, ...]
    first: Int64s
    end: Int64s
    free: Bools
    too_large: Bools
    volumes: Floats
    pieces: tuple[tuple[Floats, ...], ...]
    excess: Floats

    @cached_property
    def size(self) -> Floats:
        """Enclosing boxes of all shapes, ``(m, 3)`` mm."""
        return np.array([shape.size for shape in self.shapes]).reshape(-1, 3)

    @cached_property
    def low(self) -> Floats:
        """Least corner of the positions, ``(3,)`` mm."""
        return empty_space(self.problem).lo

    @cached_property
    def circle(self) -> Circle | None:
        """The circle that contains all outlines; None for a box-shaped build volume."""
        space = empty_space(self.problem)
        return Circle(space.axis, space.radius) if space.radius else None

    @cached_property
    def sides(self) -> Floats:
        """Sides ``(k, 3)`` of a polygon that contains the circle and is at most half the `CONTACT_TOLERANCE` larger."""
        return circle_sides(self.circle, CONTACT_TOLERANCE / 2.0) if self.circle else np.empty((0, 3))

    @cached_property
    def side_reach(self) -> Floats:
        """Greatest extent of each shape along the normal of each side, ``(m, k)`` mm."""
        normals = self.sides[:, :2]
        return np.array([(shape.outline @ normals.T).max(axis=0) for shape in self.shapes])

    @cached_property
    def mean_size(self) -> float:
        """Mean edge (mm) of cubes with the volumes of the enclosing boxes of the shapes."""
        return float(np.cbrt(self.size.prod(axis=1)).mean())

    def positions(self, height: float) -> PositionRange:
        """Return the positions of all shapes in a build of some height, mm."""
        space = empty_space(self.problem)
        lo = np.repeat(space.lo[None], len(self.shapes), axis=0)
        hi = np.array([*space.hi[:2], height]) - self.size
        hi = np.where((hi < lo) & (hi > lo - 2.0 * CONTACT_TOLERANCE), lo, hi)  # as large as the build volume
        outlines = [shape.outline for shape in self.shapes] if space.radius else []
        first = np.cumsum([0] + [len(outline) for outline in outlines]).astype(np.int64)
        corners = np.concatenate(outlines) if outlines else np.empty((0, 2))
        return PositionRange(lo, hi, float(space.radius), np.array(space.axis), corners, first)


def prepare_shapes(problem: PackingProblem, stop: Stop) -> ShapeInstance:
    """Return the shapes of a problem; copies share theirs."""
    require_values(problem)
    found = _pieces(problem, stop)
    known: dict[tuple[int, bytes], tuple[int, int, float]] = {}
    shapes: list[Shape] = []
    rows = []
    for item in problem.items:
        key = _type_of(item)
        if key not in known:
            turned = _shapes_of(problem, item, found[id(item.volume)].pieces)
            known[key] = (len(shapes), len(shapes) + len(turned), volume_of(item.volume))
            shapes += turned
        rows.append(known[key])
    first, end = np.array([row[:2] for row in rows], np.int64).reshape(-1, 2).T
    fits = np.array([any(shape.fits for shape in shapes[a:b]) for a, b, _ in rows], bool)
    free = np.ones(len(rows), bool)
    free[[placement.item for placement in problem.fixed]] = False
    volumes = np.array([row[2] for row in rows], np.float64)
    pieces = tuple(found[id(item.volume)].pieces for item in problem.items)
    excess = np.array([found[id(item.volume)].excess for item in problem.items], np.float64)
    return ShapeInstance(
        problem, tuple(shapes), first, end, free & fits, free & ~fits, volumes, pieces, excess
    )


def _pieces(problem: PackingProblem, stop: Stop) -> dict[int, PieceSet]:
    """Return the convex pieces of each volume, by its id; more of them for volumes of which there are many copies.

    With a time limit they take at most a fraction of it: then there are less, and at last only hulls.
    """
    time = TIME_FOR_PIECES * stop.remaining()
    volumes = {id(item.volume): item.volume for item in problem.items}
    copies = Counter(id(item.volume) for item in problem.items)
    total = int(min(MOST_PIECES, MOST_OF_VOLUME * len(volumes), len(volumes) + time / SECONDS_A_PIECE))
    early = stop.within(time) if np.isfinite(time) else stop
    sets = decompose_volumes(list(volumes.values()), [copies[key] for key in volumes], total, early).sets
    return {key: _inside_box(volume, each) for (key, volume), each in zip(volumes.items(), sets, strict=True)}


def _inside_box(volume: BoundingVolume, found: PieceSet) -> PieceSet:
    """Return pieces that are not beyond the enclosing box of the volume; rounding enlarged them by up to 1e-4 mm.

    So heights and walls are those of the volume.
    """
    lo, hi = volume.enclosing()
    return replace(found, pieces=tuple(np.clip(piece, lo, hi) for piece in found.pieces))


def _shapes_of(problem: PackingProblem, item: Item, pieces: Sequence[Floats]) -> list[Shape]:
    """Return one shape for each rotation of an item that gives a different one and fits an empty build."""
    matrices = item.orientations.matrices if item.orientations.freedom == "list" else np.eye(3)[None]
    found: dict[bytes, Shape] = {}
    for rotation in matrices:
        turned = [piece @ rotation.T for piece in pieces]
        least = np.concatenate(turned).min(axis=0)
        turned = [piece - least for piece in turned]
        key = _digest(turned)
        if key not in found:
            found[key] = Shape(rotation, tuple(turned), -least, _feasible_position(problem, turned))
    fitting = [shape for shape in found.values() if shape.fits]
    kept = sorted(_lowest(fitting)[: _most_orientations(problem)])
    return [fitting[k] for k in kept] or list(found.values())[:1]


def _lowest(shapes: Sequence[Shape]) -> list[int]:
    """Return the numbers of shapes by increasing height, of equal ones with different lengths and widths in turn."""
    sizes = [tuple(np.round(shape.size, 6).tolist()) for shape in shapes]
    turn = [sizes[:k].count(size) for k, size in enumerate(sizes)]
    return sorted(range(len(shapes)), key=lambda k: (sizes[k][2], turn[k], k))


def _type_of(item: Item) -> tuple[int, bytes]:
    """Return a key that is equal for items of the same type."""
    return id(item.volume), item.orientations.matrices.tobytes()


def _most_orientations(problem: PackingProblem) -> int:
    """Return how many orientations each type may keep, so that there are at most about `MOST_SHAPES` shapes."""
    return max(1, MOST_SHAPES // max(len({_type_of(item) for item in problem.items}), 1))


def _digest(pieces: list[Floats]) -> bytes:
    """Return a key that is equal for equal sets of points."""
    rounded = [np.round(piece / SAME).astype(np.int64) for piece in pieces]
    return b"|".join(sorted(points[np.lexsort(points.T)].tobytes() for points in rounded))


def _feasible_position(problem: PackingProblem, pieces: list[Floats]) -> Floats:
    """Return a position of the least corner in an empty build; NaN if none is found.

    The search is exact for boxes. For other shapes it is on the boxes around their pieces, exact in a round build
    volume without zones, and among zones on a grid of positions.
    """
    space = empty_space(problem)
    lo, hi = np.array([p.min(axis=0) for p in pieces]), np.array([p.max(axis=0) for p in pieces])
    found = find_feasible_position(lo, hi, space)
    if found is None and space.radius and not len(space.zone_lo):
        points = np.concatenate(pieces)
        inside = find_inside_circle(outline_of(points[:, :2]), Circle(space.axis, space.radius), space.slack)
        if inside is not None and points[:, 2].max() <= space.hi[2] - space.lo[2] + space.slack:
            found = np.array([*inside, space.lo[2]])
    if found is None and len(space.zone_lo):
        found = find_between_zones(pieces, space)
    return np.full(3, np.nan) if found is None else found
