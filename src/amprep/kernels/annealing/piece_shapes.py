"""Shapes that are sets of convex pieces, compared by GJK (thesis 2.5)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.annealing.records import Vector
from amprep.kernels.bounding.gjk import PieceArrays
from amprep.kernels.bounding.piece_sets import collide, directional_distance, distance
from amprep.kernels.helper import uncounted

STEPS = 20
"""Greatest number of steps of a rotation; each is proved free by a distance."""

RESERVE = 1e-6
"""mm; part of a distance that a step of a rotation leaves."""


class PieceShapes(NamedTuple):
    """The arrays of the pieces of all shapes, one after another; see `PieceArrays`.

    Attributes
    ----------
    vertices
        ``(n, 3)`` vertices of all pieces, mm.
    first
        Index of the first vertex of each piece, and of the end of each shape.
    centre, half
        Boxes of the pieces, then of the set, for each shape.
    row
        ``(shapes + 1,)`` first row of each shape in the other arrays.
    frame, ray, work
        ``(3, 4)``, ``(3,)`` and work array of the queries.
    """

    vertices: Floats
    first: Int64s
    centre: Floats
    half: Floats
    row: Int64s
    frame: Floats
    ray: Floats
    work: Floats


@uncounted
def _pieces(shapes: PieceShapes, shape: int) -> PieceArrays:
    """Return the pieces of a shape."""
    first, last = shapes.row[shape], shapes.row[shape + 1]
    return PieceArrays(
        shapes.vertices, shapes.first[first:last], shapes.centre[first:last], shapes.half[first:last]
    )


@uncounted
def _write_frame(pose_a: Floats, pose_b: Floats, frame: Floats) -> None:
    """Write the motion from the coordinates of b to those of a."""
    for r in range(3):
        for c in range(3):
            frame[r, c] = 0.0
            for k in range(3):
                frame[r, c] += pose_a[4 * k + r] * pose_b[4 * k + c]
        frame[r, 3] = 0.0
        for k in range(3):
            frame[r, 3] += pose_a[4 * k + r] * (pose_b[4 * k + 3] - pose_a[4 * k + 3])


@uncounted
def travel_of_pieces(
    shapes: PieceShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    direction: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return how far shape a may travel until it is within a margin of shape b, mm; see `engines.travel`."""
    frame, ray = shapes.frame, shapes.ray
    _write_frame(pose_a, pose_b, frame)
    for r in range(3):
        ray[r] = pose_a[r] * direction[0] + pose_a[4 + r] * direction[1] + pose_a[8 + r] * direction[2]
    return directional_distance(
        _pieces(shapes, a), _pieces(shapes, b), frame, ray, margin, limit, shapes.work
    )


@uncounted
def pieces_collide(
    shapes: PieceShapes, a: int, pose_a: Floats, b: int, pose_b: Floats, margin: float
) -> bool:
    """Return whether two shapes are closer than a margin; see `engines.collide`."""
    _write_frame(pose_a, pose_b, shapes.frame)
    return collide(_pieces(shapes, a), _pieces(shapes, b), shapes.frame, margin, shapes.work)


@uncounted
def turn_of_pieces(
    shapes: PieceShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return an angle by which shape a may turn until it is within a margin of shape b, rad; see `engines.turn`.

    The angle is not the greatest one. Conservative advancement: no point of the shape moves farther than its distance
    from `point` times the angle, so the distance of the shapes proves a step free.
    """
    one, other, frame = _pieces(shapes, a), _pieces(shapes, b), shapes.frame
    set_a, radius = one.half.shape[0] - 1, 0.0
    for r in range(3):
        at = pose_a[4 * r + 3] - point[r]
        for k in range(3):
            at += pose_a[4 * r + k] * one.centre[set_a, k]
        radius += at * at
    half = one.half[set_a]
    radius = np.sqrt(radius) + np.sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])
    angle = 0.0
    for _ in range(STEPS):
        _write_turned_frame(pose_a, pose_b, point, axis, angle, frame)
        gap = distance(one, other, frame, margin + (limit - angle) * radius + RESERVE, shapes.work)
        step = (gap - margin - RESERVE) / radius
        if step <= 0.01 * limit:
            return angle
        angle += step
        if angle >= limit:
            return limit
    return angle


@uncounted
def _write_turned_frame(
    pose_a: Floats, pose_b: Floats, point: Vector, axis: Vector, angle: float, frame: Floats
) -> None:
    """Write the motion from the coordinates of b to those of a after a turn of a.

    Turning a forwards is turning b backwards about the same axis.
    """
    c, s = np.cos(angle), -np.sin(angle)
    x, y, z = axis
    turn = (
        (c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s),
        (y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s),
        (z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)),
    )
    dx, dy, dz = pose_b[3] - point[0], pose_b[7] - point[1], pose_b[11] - point[2]
    for r in range(3):
        for k in range(4):
            frame[r, k] = 0.0
        for k in range(3):
            row = turn[k]
            away = row[0] * dx + row[1] * dy + row[2] * dz + point[k] - pose_a[4 * k + 3]
            for col in range(3):
                entry = row[0] * pose_b[col] + row[1] * pose_b[4 + col] + row[2] * pose_b[8 + col]
                frame[r, col] += pose_a[4 * k + r] * entry
            frame[r, 3] += pose_a[4 * k + r] * away
