"""The queries for arrays of poses."""

from amprep.arrays import Bools, Floats
from amprep.kernels.helper import kernel
from amprep.kernels.trees.collide import surfaces_collide
from amprep.kernels.trees.containment import contains_point, is_inside, solids_collide
from amprep.kernels.trees.directional import directional_distance
from amprep.kernels.trees.distance import surface_distance
from amprep.kernels.trees.records import ObbTree, Stack
from amprep.kernels.trees.rotational import rotational_distance


@kernel
def collide_each(
    a: ObbTree, poses_a: Floats, b: ObbTree, poses_b: Floats, margin: float, stack: Stack, answers: Bools
) -> None:
    """Write the answers of `surfaces_collide` for ``(n, 12)`` poses of both bodies."""
    for k in range(answers.shape[0]):
        answers[k] = surfaces_collide(a, poses_a[k], b, poses_b[k], margin, stack)


@kernel
def distance_each(
    a: ObbTree, poses_a: Floats, b: ObbTree, poses_b: Floats, limit: float, stack: Stack, answers: Floats
) -> None:
    """Write the answers of `surface_distance` for ``(n, 12)`` poses of both bodies."""
    for k in range(answers.shape[0]):
        answers[k] = surface_distance(a, poses_a[k], b, poses_b[k], limit, stack)


@kernel
def directional_each(
    a: ObbTree,
    poses_a: Floats,
    b: ObbTree,
    poses_b: Floats,
    directions: Floats,
    margin: float,
    limits: Floats,
    stack: Stack,
    answers: Floats,
) -> None:
    """Write the answers of `directional_distance` for ``(n, 12)`` poses and ``(n, 3)`` unit vectors."""
    for k in range(answers.shape[0]):
        direction = (directions[k, 0], directions[k, 1], directions[k, 2])
        answers[k] = directional_distance(a, poses_a[k], b, poses_b[k], direction, margin, limits[k], stack)


@kernel
def rotational_each(
    a: ObbTree,
    poses_a: Floats,
    b: ObbTree,
    poses_b: Floats,
    axes: Floats,
    margin: float,
    limit: float,
    stack: Stack,
    answers: Floats,
) -> None:
    """Write the answers of `rotational_distance` for ``(n, 12)`` poses and ``(n, 6)`` points and directions of axes."""
    for k in range(answers.shape[0]):
        point, axis = (axes[k, 0], axes[k, 1], axes[k, 2]), (axes[k, 3], axes[k, 4], axes[k, 5])
        answers[k] = rotational_distance(a, poses_a[k], b, poses_b[k], point, axis, margin, limit, stack)


@kernel
def contains_each(tree: ObbTree, points: Floats, stack: Stack, answers: Bools) -> None:
    """Write the answers of `contains_point` for ``(n, 3)`` points."""
    for k in range(answers.shape[0]):
        answers[k] = contains_point(tree, (points[k, 0], points[k, 1], points[k, 2]), stack)


@kernel
def solids_collide_each(
    a: ObbTree, poses_a: Floats, b: ObbTree, poses_b: Floats, margin: float, stack: Stack, answers: Bools
) -> None:
    """Write the answers of `solids_collide` for ``(n, 12)`` poses of both bodies."""
    for k in range(answers.shape[0]):
        answers[k] = solids_collide(a, poses_a[k], b, poses_b[k], margin, stack)


@kernel
def is_inside_each(
    a: ObbTree, poses_a: Floats, b: ObbTree, poses_b: Floats, stack: Stack, answers: Bools
) -> None:
    """Write the answers of `is_inside` for ``(n, 12)`` poses of both bodies."""
    for k in range(answers.shape[0]):
        answers[k] = is_inside(a, poses_a[k], b, poses_b[k], stack)
