"""The no-fit solids of the shapes of an instance, and the obstacles of its builds."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.no_fit.contacts import contact_shapes
from amprep.geometry.no_fit.fields import sample_fields, samples
from amprep.geometry.no_fit.pieces import ConvexPiece, ShapeSet, convex_shape, corner_pairs, with_obstacles
from amprep.geometry.no_fit.voxels import sample_from_voxels
from amprep.kernels.no_fit.records import EVERYWHERE, ContactShapes, NoFitFields
from amprep.model.control import Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.shapes import ShapeInstance

MOST_CORNER_PAIRS = 1_000_000
"""Number of pairs of corners of pieces up to which fields are sampled from exact no-fit solids, in a few seconds."""


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


def prepare_no_fit(instance: ShapeInstance, params: SeparationParams, stop: Stop) -> NoFit | None:
    """Compute no-fit solids and fields; None after a stop.

    Fields are sampled from exact no-fit solids if that takes a few seconds, else from voxels.
    """
    step = params.step * instance.mean_size
    moving = [convex_shape(shape.pieces) for shape in instance.shapes]
    shapes = _with_obstacles(instance, moving, _obstacles(instance, step))
    exact = corner_pairs(shapes) <= MOST_CORNER_PAIRS
    while (4.0 if exact else 1.0) * samples(shapes, step) > params.memory * 1e6:
        step *= 1.05
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
