"""The collision queries of the annealing, answered by the kernels of the kind of shapes: boxes, trees or pieces.

numba chooses the kernel when it compiles a caller, by the type of the shapes; without compilation, Python does.
"""

# ruff: noqa: ARG001, PLW0108 - numba calls these functions with types, and accepts no compiled function from them

from typing import Any

from numba.extending import overload

from amprep.arrays import Floats
from amprep.kernels.annealing.box_shapes import BoxShapes, boxes_collide, travel_of_boxes, turn_of_boxes
from amprep.kernels.annealing.piece_shapes import (
    PieceShapes,
    pieces_collide,
    travel_of_pieces,
    turn_of_pieces,
)
from amprep.kernels.annealing.records import Shapes, Vector
from amprep.kernels.annealing.tree_shapes import (
    ListedTreeShapes,
    TreeShapes,
    no_turn_of_trees,
    travel_of_trees,
    trees_collide,
    turn_of_trees,
)

_TRAVEL: dict[type, Any] = {
    BoxShapes: travel_of_boxes,
    TreeShapes: travel_of_trees,
    ListedTreeShapes: travel_of_trees,
    PieceShapes: travel_of_pieces,
}
_COLLIDE: dict[type, Any] = {
    BoxShapes: boxes_collide,
    TreeShapes: trees_collide,
    ListedTreeShapes: trees_collide,
    PieceShapes: pieces_collide,
}
_TURN: dict[type, Any] = {
    BoxShapes: turn_of_boxes,
    TreeShapes: turn_of_trees,
    ListedTreeShapes: no_turn_of_trees,
    PieceShapes: turn_of_pieces,
}


def travel(
    shapes: Shapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    direction: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return how far shape a may travel before it is within a margin of shape b (thesis 2.6, directional distance).

    Parameters
    ----------
    shapes
        All shapes.
    a, b
        Numbers of two shapes, which are not closer than the margin.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    direction
        Unit vector.
    margin, limit
        mm; the limit is returned if shape a may travel at least as far.
    """
    return float(_TRAVEL[type(shapes)](shapes, a, pose_a, b, pose_b, direction, margin, limit))


def collide(shapes: Shapes, a: int, pose_a: Floats, b: int, pose_b: Floats, margin: float) -> bool:
    """Return whether two shapes intersect or are closer than a margin; see `travel`."""
    return bool(_COLLIDE[type(shapes)](shapes, a, pose_a, b, pose_b, margin))


def turn(
    shapes: Shapes,
    a: int,
    pose_a: Floats,
    b: int,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
) -> float:
    """Return by which angle shape a may turn before it is within a margin of shape b (thesis 2.6, rotational distance).

    Parameters
    ----------
    point, axis
        A point on the axis and its direction, a unit vector; the turn is counter-clockwise seen against it.
    limit
        rad; returned if shape a may turn at least as far. See `travel` for the others.
    """
    return float(_TURN[type(shapes)](shapes, a, pose_a, b, pose_b, point, axis, margin, limit))


@overload(travel, jit_options={"_nrt": False})
def _travel(shapes, a, pose_a, b, pose_b, direction, margin, limit):
    kernel = _TRAVEL[shapes.instance_class]
    return lambda shapes, a, pose_a, b, pose_b, direction, margin, limit: kernel(
        shapes, a, pose_a, b, pose_b, direction, margin, limit
    )


@overload(collide, jit_options={"_nrt": False})
def _collide(shapes, a, pose_a, b, pose_b, margin):
    kernel = _COLLIDE[shapes.instance_class]
    return lambda shapes, a, pose_a, b, pose_b, margin: kernel(shapes, a, pose_a, b, pose_b, margin)


@overload(turn, jit_options={"_nrt": False})
def _turn(shapes, a, pose_a, b, pose_b, point, axis, margin, limit):
    kernel = _TURN[shapes.instance_class]
    return lambda shapes, a, pose_a, b, pose_b, point, axis, margin, limit: kernel(
        shapes, a, pose_a, b, pose_b, point, axis, margin, limit
    )
