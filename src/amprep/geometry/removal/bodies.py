"""Rigid bodies at their positions in a build."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.geometry.trees.collision_mesh import CollisionMesh, collision_mesh


class CollisionShape:
    """A mesh whose OBB tree is built when it is first needed; copies of a part share one.

    Parameters
    ----------
    vertices, triangles
        ``(v, 3)`` mm and ``(n, 3)``, n at least 1.
    is_solid
        Whether the mesh is closed and outward oriented. Both sides of the triangles of other meshes obstruct.
    """

    def __init__(self, vertices: Floats, triangles: Ints, is_solid: bool = True) -> None:
        self.vertices = vertices
        self.triangles = triangles if is_solid else np.concatenate([triangles, triangles[:, ::-1]])

    @property
    def is_built(self) -> bool:
        """Whether the tree was needed before."""
        return "tree" in vars(self)

    @cached_property
    def tree(self) -> CollisionMesh:
        """The mesh with its OBB tree."""
        return collision_mesh(self.vertices, self.triangles.astype(np.int64))


@dataclass(frozen=True, eq=False)
class MovableBody:
    """Shapes that move together, at their poses in a build.

    Attributes
    ----------
    shapes
        For example a part and its supports.
    poses
        ``(k, 4, 4)``, rigid motion of each shape.
    low, high
        ``(k, 3)`` mm, corners of the bounding box of each shape in the build.
    is_boxes
        Whether each shape is equal to its bounding box.
    """

    shapes: tuple[CollisionShape, ...]
    poses: Floats
    low: Floats
    high: Floats
    is_boxes: bool = False

    def triangles(self, i: int) -> Floats:
        """Return the corners of the triangles of a shape in the build, ``(n, 3, 3)`` mm."""
        shape, pose = self.shapes[i], self.poses[i]
        vertices = shape.vertices @ pose[:3, :3].T + pose[:3, 3]
        return np.asarray(vertices[shape.triangles])


def movable_body(placed: Sequence[tuple[CollisionShape, Floats]], is_boxes: bool = False) -> MovableBody:
    """Return the body of one or more shapes, each with its pose ``(4, 4)``; see `MovableBody`."""
    poses = np.array([pose for _, pose in placed], np.float64)
    corners = [shape.vertices @ pose[:3, :3].T + pose[:3, 3] for shape, pose in placed]
    return MovableBody(
        tuple(shape for shape, _ in placed),
        frozen(poses, np.float64),
        frozen([points.min(axis=0) for points in corners], np.float64),
        frozen([points.max(axis=0) for points in corners], np.float64),
        is_boxes,
    )
