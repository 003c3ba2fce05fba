"""The no-fit solids of the shapes of an instance, and the obstacles of its builds."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.no_fit.contacts import contact_shapes
from amprep.geometry.no_fit.fields import sample_fields, samples
from amprep.geometry.no_fit.pieces import ConvexPiece, ShapeSet, convex_shape, corner_pairs, with_obstacles
from amprep.geometry.no_fit.voxels import sample_from_voxels
from amprep.kernels.guided_search import EVERYWHERE
from amprep.kernels.no_fit.records import ContactShapes, NoFitFields
from amprep.model.control import Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.shapes import ShapeInstance

MOST_CORNER_PAIRS, SECONDS_A_PAIR = 1_000_000, 1e-5
"""Pairs of corners of pieces up to which fields are sampled from exact no-fit solids, and the time for each, s."""

SECONDS_A_MILLION = 0.03
"""Time (s) for a million samples from voxels by two threads."""

TIME_FOR_FIELDS, COARSER, COARSEST = 0.2, 2.5, 10.0
"""Fraction of a time limit for fields, factor of their step if twice that is too short, and the greatest factor."""


@dataclass(frozen=True, eq=False)
class ShapeObstacle:
    """A forbidden zone, or a fixed item of the first build.

    Attributes
    ----------
    pieces
        For each convex piece its points ``(k, 3)`` mm, relative to `position`.
    position
        ``(3,)`` mm, a grid point of the constructive pass.
    build
        0, or `EVERYWHERE`.
    clearance
        Least distance of items, mm.
    """

    pieces: tuple[Floats, ...]
    position: Floats
    build: int
    clearance: float


@dataclass(frozen=True, eq=False)
class NoFit:
    """The convex pieces of the shapes of an instance, the fields of their no-fit solids, and the obstacles.

    Attributes
    ----------
    exact
        Whether the samples of the fields are exact: no overlap at samples that show none.
    """

    contacts: ContactShapes
    fields: NoFitFields
    obstacles: tuple[ShapeObstacle, ...]
    exact: bool

    @cached_property
    def obstacle_top(self) -> float:
        """Height (mm) of the highest obstacle; 0 without any."""
        tops = (float(o.position[2] + np.concatenate(o.pieces)[:, 2].max()) for o in self.obstacles)
        return max(tops, default=0.0)


def prepare_no_fit(instance: ShapeInstance, params: SeparationParams, stop: Stop) -> NoFit | None:
    """Compute no-fit solids and fields; None when time is too short.

    Fields are sampled from exact no-fit solids if that takes a few seconds, else from voxels. With a time limit they
    may take a fraction of it: then the step is larger.
    """
    if stop():
        return None
    step = params.step * instance.mean_size
    moving = [convex_shape(shape.pieces) for shape in instance.shapes]
    shapes = _with_obstacles(instance, moving, _obstacles(instance, step))
    seconds = TIME_FOR_FIELDS * stop.remaining()
    pairs = corner_pairs(shapes)
    if pairs <= MOST_CORNER_PAIRS and pairs * SECONDS_A_PAIR <= seconds:
        return _sampled(instance, moving, _step(shapes, step, params.memory / 4.0), stop, exact=True)
    step = _step(shapes, step, min(params.memory, seconds / SECONDS_A_MILLION))
    for coarser in (1.0, COARSER):
        early = stop.within(2.0 * seconds) if np.isfinite(seconds) else stop
        found = _sampled(instance, moving, coarser * step, early, exact=False)
        if found is not None or stop():
            return found
    return None


def _step(shapes: ShapeSet, step: float, millions: float) -> float:
    """Return the least step from a given one to `COARSEST` times it with at most some millions of samples."""
    most = COARSEST * step
    while step < most and samples(shapes, step) > millions * 1e6:
        step *= 1.05
    return step


def _sampled(
    instance: ShapeInstance, moving: list[list[ConvexPiece]], step: float, stop: Stop, *, exact: bool
) -> NoFit | None:
    obstacles = _obstacles(instance, step)
    shapes = _with_obstacles(instance, moving, obstacles)
    fields = (sample_fields if exact else sample_from_voxels)(shapes, step, stop)
    return None if fields is None else NoFit(contact_shapes(shapes), fields, obstacles, exact)


def _with_obstacles(
    instance: ShapeInstance, moving: list[list[ConvexPiece]], obstacles: tuple[ShapeObstacle, ...]
) -> ShapeSet:
    clearances = [instance.problem.clearance, *(obstacle.clearance for obstacle in obstacles)]
    return with_obstacles(moving, [obstacle.pieces for obstacle in obstacles], clearances)


def _obstacles(instance: ShapeInstance, step: float) -> tuple[ShapeObstacle, ...]:
    """Return the forbidden zones and the fixed items; positions are multiples of two steps from the least position."""
    problem, found = instance.problem, []
    for lo, hi in zip(problem.space.zone_lo, problem.space.zone_hi, strict=True):
        if (hi > lo).all():
            found.append(([_corners(lo, hi)], EVERYWHERE, 0.0))
    for fixed in problem.fixed:
        moved = [piece @ fixed.rotation.T + fixed.translation for piece in instance.pieces[fixed.item]]
        found.append((moved, 0, problem.clearance))
    obstacles = []
    for pieces, build, clearance in found:
        least = np.concatenate(pieces).min(axis=0)
        position = instance.low + 2.0 * step * np.floor((least - instance.low) / (2.0 * step))
        obstacles.append(
            ShapeObstacle(tuple(piece - position for piece in pieces), position, build, clearance)
        )
    return tuple(obstacles)


def _corners(lo: Floats, hi: Floats) -> Floats:
    return np.array([[x, y, z] for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])])
