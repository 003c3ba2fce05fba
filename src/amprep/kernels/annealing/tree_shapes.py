"""Shapes that are closed meshes with OBB trees (thesis 2.6)."""

# ruff: noqa: ARG001 - every engine takes the same arguments

from typing import NamedTuple

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.annealing.records import Vector
from amprep.kernels.helper import uncounted
from amprep.kernels.trees.collide import surfaces_collide
from amprep.kernels.trees.directional import directional_distance
from amprep.kernels.trees.records import ObbTree, Stack
from amprep.kernels.trees.rotational import rotational_distance

NODES, CORNERS, SAMPLES, HULL, DEPTH = 0, 1, 2, 3, 4
"""Columns of `TreeShapes.first`."""


class TreeShapes(NamedTuple):
    """The arrays of the trees of all shapes, one after another; see `ObbTree`.

    Attributes
    ----------
    first
        ``(shapes + 1, 5)`` first row of each shape in the arrays; the last column is the depth of its tree.
    stack
        Work arrays for the depth of any two of the trees.
    """

    nodes: Floats
    link: Int32s
    cones: Floats
    corners: Floats
    normals: Floats
    order: Int64s
    samples: Floats
    hull: Floats
    first: Int64s
    stack: Stack


class ListedTreeShapes(TreeShapes):
    """Trees of shapes of which none may be turned by any angle: the kernels for rotations are not compiled."""


@uncounted
def _tree(shapes: TreeShapes, shape: int) -> ObbTree:
    """Return the tree of a shape."""
    first, last = shapes.first[shape], shapes.first[shape + 1]
    return ObbTree(
        shapes.nodes[first[NODES] : last[NODES]],
        shapes.link[first[NODES] : last[NODES]],
        shapes.cones[first[NODES] : last[NODES]],
        shapes.corners[first[CORNERS] : last[CORNERS]],
        shapes.normals[first[CORNERS] : last[CORNERS]],
        shapes.order[first[CORNERS] : last[CORNERS]],
        shapes.samples[first[SAMPLES] : last[SAMPLES]],
        shapes.hull[first[HULL] : last[HULL]],
        first[DEPTH],
    )


@uncounted
def travel_of_trees(
    shapes: TreeShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    direction: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return how far shape a may travel until it is within a margin of shape b, mm; see `engines.travel`."""
    return directional_distance(
        _tree(shapes, a), pose_a, _tree(shapes, b), pose_b, direction, margin, limit, shapes.stack
    )


@uncounted
def trees_collide(shapes: TreeShapes, a: int, pose_a: Floats, b: int, pose_b: Floats, margin: float) -> bool:
    """Return whether the surfaces of two shapes intersect or are closer than a margin; see `engines.collide`."""
    return surfaces_collide(_tree(shapes, a), pose_a, _tree(shapes, b), pose_b, margin, shapes.stack)


@uncounted
def turn_of_trees(
    shapes: TreeShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return by which angle shape a may turn until it is within a margin of shape b, rad; see `engines.turn`."""
    return rotational_distance(
        _tree(shapes, a), pose_a, _tree(shapes, b), pose_b, point, axis, margin, limit, shapes.stack
    )


@uncounted
def no_turn_of_trees(
    shapes: ListedTreeShapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return 0: these shapes turn by re-insertion only."""
    return 0.0
