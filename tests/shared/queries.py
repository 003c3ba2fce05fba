"""The collision queries of the annealing as functions that Python can call."""

from amprep.kernels.annealing import engines
from amprep.kernels.helper import kernel


@kernel
def travel(shapes, a, pose_a, b, pose_b, direction, margin, limit):
    return engines.travel(shapes, a, pose_a, b, pose_b, direction, margin, limit)


@kernel
def collide(shapes, a, pose_a, b, pose_b, margin):
    return engines.collide(shapes, a, pose_a, b, pose_b, margin)


@kernel
def turn(shapes, a, pose_a, b, pose_b, point, axis, margin, limit):
    return engines.turn(shapes, a, pose_a, b, pose_b, point, axis, margin, limit)
