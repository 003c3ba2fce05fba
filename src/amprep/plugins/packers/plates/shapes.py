"""A packing problem prepared for plates: outlines, shapes, positions and obstacles."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s
from amprep.geometry.no_fit.circle import Circle, circle_sides
from amprep.geometry.plates.outline import ShadowOutline
from amprep.kernels.plates.records import PlateShapes
from amprep.model.packing import PackingProblem, Placement
from amprep.plugins.packers.instance.prepare import empty_space


@dataclass(frozen=True, eq=False)
class ShadowShape:
    """The shadow of a volume in one orientation: an outline after quarter turns.

    Attributes
    ----------
    rotation
        ``(3, 3)`` rotation of the volume.
    outline, quarter
        Number of the outline, and of quarter turns.
    half
        ``(2,)`` mm, half the sides of the enclosing box.
    height
        mm.
    shift
        ``(3,)`` mm, from the centre of the enclosing box at the lowest point to the origin of the turned volume.
    alone
        ``(2,)`` mm, a position of the centre in an empty build; NaN when none is known.
    beside_zones
        ``(2,)`` mm, one where the shadow overlaps a forbidden zone but the volume does not; NaN when none is known.
    """

    rotation: Floats
    outline: int
    quarter: int
    half: Floats
    height: float
    shift: Floats
    alone: Floats
    beside_zones: Floats

    @property
    def fits(self) -> bool:
        """Whether a position in an empty build is known at which the shadow overlaps no zone."""
        return bool(np.isfinite(self.alone[0]))

    @property
    def fits_alone(self) -> bool:
        """Whether only a position is known at which the shadow overlaps a zone."""
        return not self.fits and bool(np.isfinite(self.beside_zones[0]))


class PlateObstacle(NamedTuple):
    """A forbidden zone, a fixed item of the first plate, or the edge of a round plate.

    Attributes
    ----------
    outline, position
        Number of an outline, which is relative to a position ``(2,)`` mm.
    plate
        0, or `EVERYWHERE`.
    clearance
        Least distance of items, mm.
    low, high
        Heights (mm) between which it excludes items.
    """

    outline: int
    position: Floats
    plate: int
    clearance: float
    low: float
    high: float


class LeastNeed(NamedTuple):
    """Area (mm2) that an item takes of a plate at least, and its least height, mm."""

    area: float
    height: float


@dataclass(frozen=True, eq=False)
class PlateInstance:
    """A packing problem prepared for plates.

    Attributes
    ----------
    outlines
        The outlines of all types, of which quarter turns share one, and of obstacles, in the order of increasing area;
        the edge of a round plate is last.
    shapes
        The shapes of all types, those of a type one after another.
    obstacles
        Zones, then fixed items, then the edge of a round plate.
    first, end
        ``(n,)`` range of the shapes of each item.
    free
        ``(n,)`` items for the search: neither fixed, nor too large, nor `alone`.
    alone
        ``(n,)`` items that get a build of their own: their shadow overlaps a forbidden zone at all known positions.
    too_large
        ``(n,)`` items without a known position in an empty build.
    needs
        For each item.
    """

    problem: PackingProblem
    outlines: tuple[ShadowOutline, ...]
    shapes: tuple[ShadowShape, ...]
    obstacles: tuple[PlateObstacle, ...]
    first: Int64s
    end: Int64s
    free: Bools
    alone: Bools
    too_large: Bools
    needs: tuple[LeastNeed, ...]

    @cached_property
    def half(self) -> Floats:
        """Half the sides of the enclosing boxes of all shapes, ``(s, 2)`` mm."""
        return np.array([shape.half for shape in self.shapes]).reshape(-1, 2)

    @cached_property
    def mean_size(self) -> float:
        """Mean edge (mm) of squares with the areas of the enclosing boxes of the shapes."""
        return float(np.sqrt(4.0 * self.half.prod(axis=1)).mean())

    @cached_property
    def arrays(self) -> PlateShapes:
        """The shapes, then one for each obstacle, as the kernels read them."""
        space, k = empty_space(self.problem), len(self.obstacles)
        lo, hi = space.lo[:2] + self.half, space.hi[:2] - self.half
        if space.radius:
            lo = np.maximum(lo, space.axis - space.radius + self.half)
            hi = np.minimum(hi, space.axis + space.radius - self.half)
        tight = (hi < lo) & (hi > lo - 4.0 * CONTACT_TOLERANCE)  # as large as the plate
        lo = np.where(tight, (lo + hi) / 2.0, lo)
        hi = np.where(tight, lo, hi)
        return PlateShapes(
            np.array([*(s.outline for s in self.shapes), *(o.outline for o in self.obstacles)], np.int64),
            np.array([*(s.quarter for s in self.shapes), *([0] * k)], np.int64),
            np.concatenate((lo, np.zeros((k, 2)))),
            np.concatenate((hi, np.zeros((k, 2)))),
        )

    @cached_property
    def conflict(self) -> Bools:
        """Which outlines exclude each other, ``(m, m)``: obstacles only at their heights."""
        lift, found = self.problem.lift, np.ones((len(self.outlines),) * 2, bool)
        for shape in self.shapes:
            for obstacle in self.obstacles:
                if obstacle.low >= lift + shape.height or obstacle.high <= lift:
                    found[shape.outline, obstacle.outline] = found[obstacle.outline, shape.outline] = False
        return found

    @property
    def radius(self) -> float:
        """Radius (mm) of the circle that contains all outlines; 0 for plates that are not round."""
        return float(empty_space(self.problem).radius)

    @cached_property
    def sides(self) -> Floats:
        """Sides ``(k, 3)`` of a polygon that contains the circle and is hardly larger."""
        circle = Circle(empty_space(self.problem).axis, self.radius)
        return circle_sides(circle, CONTACT_TOLERANCE / 2.0) if self.radius else np.empty((0, 3))

    @cached_property
    def side_reach(self) -> Floats:
        """Greatest extent of each shape along the normal of each side, ``(s, k)`` mm."""
        normals = self.sides[:, :2]
        hulls = [turned(self.outlines[shape.outline].hull, shape.quarter) for shape in self.shapes]
        return np.array([(hull @ normals.T).max(axis=0) for hull in hulls]).reshape(len(hulls), -1)

    def placement(self, item: int, shape: int, position: Floats) -> Placement:
        """Return the placement of an item whose centre is at a position ``(2,)`` mm."""
        chosen = self.shapes[shape]
        return Placement(item, chosen.rotation, np.array([*position, self.problem.lift]) + chosen.shift)


def turned(points: Floats, quarter: int) -> Floats:
    """Return points ``(n, 2)`` after quarter turns."""
    for _ in range(quarter):
        points = np.column_stack((-points[:, 1], points[:, 0]))
    return points
