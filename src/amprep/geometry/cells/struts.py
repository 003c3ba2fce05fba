"""Make solids of struts and walls in the unit cube, with the requested radii and thickness after the map of an edge."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.cells.ports import conform
from amprep.geometry.meshes.topology import first_of_equal_rows

if TYPE_CHECKING:
    from manifold3d import Manifold


SIDES = 8
"""Corners of the cross-section of a strut. The polygon has the area of the circle."""

_BALL_SEGMENTS = 8

_PERPENDICULAR = 0.999
"""Sine of the angle above which a strut is perpendicular to a side of the cube."""

_LEAST_SINE = 0.5
"""Sine of the angle to a side (30 degrees) below which balls at ports do not grow any more."""


class Graph(NamedTuple):
    """Graph of struts and walls.

    Attributes
    ----------
    points
        ``(n, 3)`` in the unit cube.
    struts, radii
        ``(m, 2)`` indices into `points`, and ``(m, 2)`` mm at both ends.
    faces, thickness
        ``(k, 3)`` indices into `points`, and mm.
    """

    points: Floats
    struts: Int64s
    radii: Floats
    faces: Int64s
    thickness: float


def graph_solid(graph: Graph, linear: Floats) -> MeshArrays:
    """Return struts, balls at their ends, and walls as one closed mesh in the unit cube.

    A ball at a port is as large as the widest section of its struts with the side of the cube. Cells of all directions
    therefore meet in equal discs.

    Parameters
    ----------
    graph
        Struts and walls.
    linear
        ``(3, 3)``, linear part of the map from the unit cube to mm.

    Returns
    -------
    points, triangles
        Opposite sides have the same triangles if their ports match.
    """
    from manifold3d import Manifold, OpType

    places = graph.points @ linear.T
    solids = [
        _strut(places[a], places[b], float(r), float(s))
        for (a, b), (r, s) in zip(graph.struts, graph.radii, strict=True)
    ]
    solids += [_ball(places[i], radius) for i, radius in _balls(graph, linear) if radius > 0.0]
    solids += [_wall(places[face], graph.thickness) for face in graph.faces] if graph.thickness else []
    back = np.column_stack([np.linalg.inv(linear), np.zeros(3)])
    whole = Manifold.batch_boolean(solids, OpType.Add).transform(back)
    inside = whole ^ Manifold.cube([1.0, 1.0, 1.0])
    mesh = inside.to_mesh64()
    points = np.array(mesh.vert_properties[:, :3], np.float64)
    return conform(points, np.array(mesh.tri_verts, np.int64))


def angles_deg(points: Floats, struts: Int64s, linear: Floats) -> Floats:
    """Return the angle of each mapped strut to the horizontal in degrees, ``(m,)``; vertical struts have 90.

    Parameters
    ----------
    points, struts
        ``(n, 3)`` in the unit cube, and ``(m, 2)`` indices.
    linear
        ``(3, 3)`` linear part of the map from the unit cube to mm.
    """
    along = (points[struts[:, 1]] - points[struts[:, 0]]) @ linear.T
    return np.degrees(np.arctan2(np.abs(along[:, 2]), np.hypot(along[:, 0], along[:, 1])))


def _balls(graph: Graph, linear: Floats) -> list[tuple[int, float]]:
    """Return the points that need a ball and its radius (mm): all but ports with a single, perpendicular strut."""
    normals = np.linalg.inv(linear)  # row k is the normal of the mapped sides across axis k
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    radius = np.zeros(len(graph.points))
    perpendicular = np.bincount(graph.struts.ravel(), minlength=len(radius)) == 1
    for (a, b), radii in zip(graph.struts.tolist(), graph.radii.tolist(), strict=True):
        along = linear @ (graph.points[b] - graph.points[a])
        slope = np.abs(normals @ along) / np.linalg.norm(along)
        for end, own in ((a, radii[0]), (b, radii[1])):
            flush = (graph.points[end] == 0.0) | (graph.points[end] == 1.0)
            crossed = slope[flush & (slope > 1e-9)]
            steepest = float(crossed.min(initial=1.0))
            perpendicular[end] &= len(crossed) == 1 and steepest > _PERPENDICULAR
            radius[end] = max(radius[end], own / max(steepest, _LEAST_SINE))
    # a port and its images on the opposite sides are one place
    place = first_of_equal_rows(np.where(graph.points == 1.0, 0.0, graph.points))
    largest, plain = np.zeros(len(radius)), np.ones(len(radius), np.bool_)
    np.maximum.at(largest, place, radius)
    np.logical_and.at(plain, place, perpendicular)
    return [(i, float(largest[place[i]])) for i in np.flatnonzero(~plain[place]).tolist()]


def _ball(centre: Floats, radius: float) -> "Manifold":
    from manifold3d import Manifold

    ball = Manifold.sphere(1.0, _BALL_SEGMENTS)
    scale = radius * float(np.cbrt(4.0 / 3.0 * np.pi / ball.volume()))
    return ball.scale([scale] * 3).translate(centre.tolist())


def _strut(start: Floats, end: Floats, first: float, last: float) -> "Manifold":
    """Return a prism or frustum; its corners do not depend on the order of the ends."""
    from manifold3d import Manifold

    along = (end - start) / np.linalg.norm(end - start)
    if tuple(np.sign(np.round(along, 9))[::-1]) < (0.0, 0.0, 0.0):
        along = -along
    right = np.cross(along, np.eye(3)[int(np.abs(np.round(along, 9)).argmin())])
    right /= np.linalg.norm(right)
    up = np.cross(along, right)
    angle = (np.arange(SIDES) + 0.5) * 2.0 * np.pi / SIDES
    same_area = np.sqrt(2.0 * np.pi / (SIDES * np.sin(2.0 * np.pi / SIDES)))
    ring = same_area * (np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up)
    return Manifold.hull_points(np.vstack([start + first * ring, end + last * ring]))


def _wall(corners: Floats, thickness: float) -> "Manifold":
    """Return a triangle as a plate, enlarged on all sides, so that plates join that meet at an angle."""
    from manifold3d import Manifold

    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    first = corners[1] - corners[0]
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    angle = (np.arange(SIDES) + 0.5) * 2.0 * np.pi / SIDES
    ring = 0.75 * thickness * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second)
    disc = np.vstack([ring + 0.5 * thickness * normal, ring - 0.5 * thickness * normal])
    return Manifold.hull_points((corners[:, None, :] + disc[None]).reshape(-1, 3))
