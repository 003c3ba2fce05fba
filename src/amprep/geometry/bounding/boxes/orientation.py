"""Smallest enclosing boxes over all directions of the faces of a convex hull (thesis 2.3)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s

_ALIKE = 1e-7
"""Directions whose components differ by less are one."""

_CHUNK = 256


class Hull(NamedTuple):
    """Convex hull of points in space.

    Attributes
    ----------
    points
        ``(n, 3)`` mm corners.
    normals
        ``(m, 3)`` outer unit normals of its triangles.
    areas
        ``(m,)`` mm2 areas of its triangles.
    edges
        ``(e, 4)`` two corners of each edge and the triangles on its two sides; None if triangles do not match.
    """

    points: Floats
    normals: Floats
    areas: Floats
    edges: Int64s | None


def hull_of(points: Floats) -> Hull | None:
    """Return the convex hull of points; None if they are in a plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    corners = points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normal, axis=1) / 2
    number = np.zeros(len(points), np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    edges = _edges(number[hull.simplices])
    return Hull(points[hull.vertices], hull.equations[:, :3].copy(), areas, edges)


def _edges(triangles: Int64s) -> Int64s | None:
    """Return the edges with the triangles on both sides; None unless each has two."""
    ends = np.sort(np.concatenate((triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]])), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    one, two = order[::2], order[1::2]
    if (
        len(order) % 2
        or (ends[one] != ends[two]).any()
        or (ends[one[1:]] == ends[two[:-1]]).all(axis=1).any()
    ):
        return None
    return np.column_stack((ends[one], owner[one], owner[two]))


def smallest_box_rotation(hull: Hull) -> tuple[float, Floats]:
    """Return the least volume of a box with a face parallel to a face of the hull, and the rotation to it.

    Strategy: for a direction of the box, the hull is projected along it. The smallest rectangle around a convex
    polygon has a side on one of its sides (Freeman and Shapira 1975), so all are tried. Opposite and coplanar faces
    are one direction. The height times the area of the projection is a lower bound on the volume: directions are
    tried in its order, until it reaches the best volume.

    Returns
    -------
    volume
        mm3.
    rotation
        ``(3, 3)``; the face of the hull is parallel to the plate afterwards.
    """
    directions, _ = distinct_directions(hull.normals)
    bounds = _lower_bounds(hull, directions)
    best, rotation = np.inf, np.eye(3)
    for number in np.argsort(bounds, kind="stable"):
        if bounds[number] >= best:
            break
        volume, found = _around(hull, directions[number])
        if volume < best:
            best, rotation = volume, found
    return best, rotation


def distinct_directions(normals: Floats) -> tuple[Floats, Int64s]:
    """Return one of each group of parallel directions, upwards where they are not level, and the group of each."""
    largest = np.abs(normals).argmax(axis=1)
    signs = np.sign(normals[np.arange(len(normals)), largest])
    along = normals * signs[:, None]
    alike = np.round(along / _ALIKE).astype(np.int64)
    _, first, number = np.unique(alike, axis=0, return_index=True, return_inverse=True)
    chosen = along[first]
    return np.where(chosen[:, 2:] < 0, -chosen, chosen), number.reshape(-1)


def upright_rotation(direction: Floats) -> Floats:
    """Return a rotation that turns a direction upwards, ``(3, 3)``."""
    across = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    across /= np.linalg.norm(across)
    return np.stack((across, np.cross(direction, across), direction))


def _lower_bounds(hull: Hull, directions: Floats) -> Floats:
    """Return for each direction the height of the hull along it times the area of its projection."""
    bounds = np.empty(len(directions))
    for start in range(0, len(directions), _CHUNK):
        some = directions[start : start + _CHUNK].T
        along = hull.points @ some
        projected = hull.areas @ np.abs(hull.normals @ some) / 2
        bounds[start : start + _CHUNK] = (along.max(axis=0) - along.min(axis=0)) * projected
    return bounds * (1 - 1e-12)


def _around(hull: Hull, direction: Floats) -> tuple[float, Floats]:
    """Return the least volume of a box with an axis along a direction, and the rotation to it."""
    to_z = upright_rotation(direction)
    volume, turn = smallest_box_about_z(_outer_points(hull, direction) @ to_z.T)
    return volume, turn @ to_z


def _outer_points(hull: Hull, direction: Floats) -> Floats:
    """Return the corners between triangles that face a direction and others, and the two ends along it.

    Each corner of the projection along the direction is among them.
    """
    if hull.edges is None:
        return hull.points
    facing = hull.normals @ direction > 0
    outline = hull.edges[facing[hull.edges[:, 2]] != facing[hull.edges[:, 3]], :2]
    along = hull.points @ direction
    return hull.points[np.unique(np.append(outline, (along.argmin(), along.argmax())))]


def _extent(points: Floats, directions: Floats) -> Floats:
    along = points @ directions.T
    return np.asarray(along.max(axis=0) - along.min(axis=0))


def outline_of(points: Floats) -> Floats:
    """Return the corners ``(n, 2)`` of the convex hull of points in the plane, in order; the ends of a line."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        spread = points - points.mean(axis=0)
        along = spread @ np.linalg.svd(spread, full_matrices=False)[2][0]
        return np.asarray(points[[int(along.argmin()), int(along.argmax())]])


def angles_of(sides: Floats) -> Floats:
    """Return the rotations (rad) about z, in [0, pi/2), that make one of the vectors ``(n, 2)`` parallel to an axis."""
    return np.unique(np.round(np.mod(-np.arctan2(sides[:, 1], sides[:, 0]), np.pi / 2), 12))


def about_z(angle: float) -> Floats:
    """Return the rotation by an angle (rad) about z, ``(3, 3)``; exact for angle 0."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def smallest_box_about_z(points: Floats) -> tuple[float, Floats]:
    """Return the least volume of a box with vertical sides, and the rotation about z to it."""
    outline = outline_of(points[:, :2])
    angles = angles_of(np.roll(outline, -1, axis=0) - outline)
    u = np.column_stack((np.cos(angles), -np.sin(angles)))
    areas = _extent(outline, u) * _extent(outline, np.column_stack((-u[:, 1], u[:, 0])))
    best = int(areas.argmin())
    return float(areas[best] * np.ptp(points[:, 2])), about_z(float(angles[best]))


def flat_rotation(points: Floats) -> Floats:
    """Return the rotation ``(3, 3)`` that lays points in a plane level, in the smallest rectangle around them."""
    spread = points - points.mean(axis=0)
    to_z = upright_rotation(np.linalg.svd(np.vstack((spread, np.zeros((3, 3)))), full_matrices=False)[2][2])
    return np.asarray(smallest_box_about_z(points @ to_z.T)[1] @ to_z)
