"""K-means clusters in the common orientation in which their enclosing boxes are smallest (thesis 2.3)."""

from typing import Literal, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, Ints
from amprep.geometry.bounding.boxes.cells import cells_of
from amprep.geometry.bounding.boxes.k_means import cluster_boxes
from amprep.geometry.bounding.boxes.orientation import (
    about_z,
    angles_of,
    distinct_directions,
    hull_of,
    outline_of,
    upright_rotation,
)
from amprep.geometry.bounding.boxes.union import union_volumes

_ROUNDS = 5
"""Greatest number of rotations, each followed by a new clustering."""

_DIRECTIONS = 40
"""Greatest number of directions of hull faces that are tried, those of the largest area first."""

_SIDES = 48
"""Greatest number of sides of outlines that are tried, the longest first."""


class _Clustering(NamedTuple):
    """Clusters of the cells of a mesh after a rotation; points of the mesh are those before it."""

    rotation: Floats
    points: Floats
    labels: Int64s
    boxes: Floats
    volume: float


def turned_clusters(
    vertices: Floats,
    triangles: Ints,
    count: int,
    *,
    cells: int,
    restarts: int,
    freedom: Literal["about-z", "free"],
    rng: np.random.Generator,
) -> tuple[Floats, Floats]:
    """Cluster the surface, and find the rotation for which the boxes around the clusters have the least union.

    Strategy: the two steps of k-means, with one more in the first: the clusters are enclosed in the best common
    orientation. Tried are the directions of the faces of the clusters' convex hulls, and in each of them, or about z
    alone, the sides of their outlines. The mesh is then divided into cells and clustered anew in this orientation,
    from random starts, until the union no longer shrinks.

    Parameters
    ----------
    vertices, triangles
        The mesh.
    count, cells, restarts, rng
        Number of clusters, cells along the longest side, random starts in each orientation, and their generator.
    freedom
        ``about-z`` or ``free``.

    Returns
    -------
    rotation, boxes
        ``(3, 3)``, and ``(k, 6)`` mm boxes that contain the surface after the rotation.
    """

    def clustered(rotation: Floats) -> _Clustering:
        turned = vertices @ rotation.T
        items = cells_of(turned, triangles, cells).items
        labels, boxes = cluster_boxes(items, count, restarts, rng)
        centres = (items[:, :3] + items[:, 3:]) / 2 @ rotation
        return _Clustering(rotation, centres, labels, boxes, float(union_volumes(boxes[None])[0]))

    best = clustered(np.eye(3))
    current = best
    for _ in range(_ROUNDS):
        clusters = [current.points[current.labels == k] for k in np.unique(current.labels)]
        rotation = _best_rotation(clusters, current.rotation, freedom)
        if np.allclose(rotation, current.rotation):
            break
        current = clustered(rotation)
        if current.volume >= best.volume:
            break
        best = current
    return best.rotation, best.boxes


def _best_rotation(clusters: list[Floats], now: Floats, freedom: str) -> Floats:
    """Return the rotation for which the boxes around clusters of points have the least union."""
    uprights = [now] if freedom == "about-z" else [now, *_face_rotations(clusters)]
    tried = [_best_about_z([points @ upright.T for points in clusters]) for upright in uprights]
    least = int(np.argmin([volume for volume, _ in tried]))
    return np.asarray(tried[least][1] @ uprights[least])


def _face_rotations(clusters: list[Floats]) -> list[Floats]:
    """Return rotations that make faces of the clusters' hulls parallel to the plate, the largest faces first."""
    hulls = [hull for points in clusters if (hull := hull_of(points)) is not None]
    if not hulls:
        return []
    normals = np.concatenate([hull.normals for hull in hulls])
    areas = np.concatenate([hull.areas for hull in hulls])
    directions, number = distinct_directions(normals)
    order = np.argsort(-np.bincount(number, areas), kind="stable")[:_DIRECTIONS]
    return [upright_rotation(directions[n]) for n in order]


def _best_about_z(clusters: list[Floats]) -> tuple[float, Floats]:
    """Return the least union of boxes over rotations about z along sides of the clusters' outlines, and the best."""
    outlines = [outline_of(points[:, :2]) for points in clusters]
    sides = np.concatenate([np.roll(outline, -1, axis=0) - outline for outline in outlines])
    longest = np.argsort(-np.linalg.norm(sides, axis=1), kind="stable")[:_SIDES]
    angles = np.append(0.0, angles_of(sides[longest]))
    u = np.column_stack((np.cos(angles), -np.sin(angles)))
    v = np.column_stack((-u[:, 1], u[:, 0]))
    boxes = np.empty((len(angles), len(clusters), 6))
    for k, (points, outline) in enumerate(zip(clusters, outlines, strict=True)):
        for axis, along in enumerate((outline @ u.T, outline @ v.T)):
            boxes[:, k, axis], boxes[:, k, axis + 3] = along.min(axis=0), along.max(axis=0)
        boxes[:, k, 2], boxes[:, k, 5] = points[:, 2].min(), points[:, 2].max()
    volumes = union_volumes(boxes)
    least = int(volumes.argmin())
    return float(volumes[least]), about_z(float(angles[least]))
