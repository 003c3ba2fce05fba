"""Exact convex decomposition of small meshes by binary space partition along their faces."""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats, Int64s
from amprep.geometry.bounding.convex.prepared import extreme_points

if TYPE_CHECKING:
    from manifold3d import Manifold

# Strategy. The bounding box is cut along the plane of a face, both halves along planes of the faces inside them, and
# so on (Fuchs, Kedem, Naylor 1980, doi:10.1145/965105.807481), until no face is inside a cell. Then a cell is inside
# or outside the mesh as a whole, which the winding number of its centre tells; the mesh may have small gaps (Jacobson,
# Kavan, Sorkine-Hornung 2013, doi:10.1145/2461912.2461916). The plane that cuts fewest faces is taken, of equals the
# one with most faces in it. At last cells are joined in pairs whose hull is not larger than both of them.

MOST_FACES = 300
"""Number of triangles up to which the decomposition is quick: it takes half a second at most then."""

MOST_CELLS = 100
"""Number of cells from which on the decomposition is given up: a curved mesh needs more than packing can use."""

IN_PLANE = 1e-5
"""Distance from a plane that counts as none, as a fraction of the size of the mesh; at most `CONTACT_TOLERANCE` / 2."""

EMPTY = 0.2
"""Volume of a cell over its surface, as a fraction of the distance that counts as none, up to which it is left out."""

NEAR = 1e-4
"""Distance of pieces that touch, as a fraction of the largest coordinate."""

CONVEX = 1e-6
"""Excess of the hull over the volume of a mesh, as a fraction of it, up to which the mesh is convex."""


class Facet(NamedTuple):
    """A convex polygon ``(k, 3)`` and its plane: unit normal ``(3,)`` and offset."""

    corners: Floats
    normal: Floats
    offset: float


def exact_pieces(vertices: Floats, triangles: Int64s, stop: Callable[[], bool]) -> list[Floats] | None:
    """Return convex pieces whose union is the inside of a mesh: for each the corners ``(k, 3)``.

    Parameters
    ----------
    vertices, triangles
        The mesh, which may be open: points with a winding number above a half are inside.
    stop
        Asked at each cut.

    Returns
    -------
    The pieces; None after a stop, if nothing is inside, or if there are more than `MOST_CELLS`.
    """
    if _is_convex(vertices, triangles):
        return [extreme_points(vertices)]
    cells = _cells(vertices, triangles, stop)
    return _joined(cells, stop) if cells else None


def _is_convex(vertices: Floats, triangles: Int64s) -> bool:
    """Return whether the volume of a mesh is that of its hull."""
    hull = hull_volume(vertices)
    a, b, c = (vertices - vertices.mean(axis=0))[triangles].swapaxes(0, 1)
    return bool(0.0 < hull <= np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 * (1.0 + CONVEX))


def _cells(vertices: Floats, triangles: Int64s, stop: Callable[[], bool]) -> list[Floats]:
    """Return the corners of the cells inside the mesh; none after a stop, or if there are too many."""
    from manifold3d import Manifold

    lo, hi = vertices.min(axis=0), vertices.max(axis=0)
    near = min(IN_PLANE * float((hi - lo).max()), CONTACT_TOLERANCE / 2.0)
    box = Manifold.cube((hi - lo).tolist()).translate(lo.tolist())
    inside: list[Floats] = []
    todo: list[tuple[Manifold, list[Facet]]] = [(box, _facets(vertices[triangles], near))]
    while todo:
        if stop() or len(inside) + len(todo) > MOST_CELLS:
            return []
        cell, facets = todo.pop()
        if facets:
            todo += _cut(cell, facets, near)
        elif cell.volume() > EMPTY * near * cell.surface_area():
            corners = np.asarray(cell.to_mesh64().vert_properties[:, :3])
            if winding_number(vertices[triangles], corners.mean(axis=0)) > 0.5:
                inside.append(corners)
    return inside


def _facets(corners: Floats, near: float) -> list[Facet]:
    """Return triangles ``(m, 3, 3)`` as facets, without degenerate ones."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    kept = np.flatnonzero(length > near * near)
    unit = normal[kept] / length[kept, None]
    offset = np.einsum("ij,ij->i", corners[kept].mean(axis=1), unit)
    return [Facet(c, n, float(d)) for c, n, d in zip(corners[kept], unit, offset, strict=True)]


def _cut(cell: "Manifold", facets: list[Facet], near: float) -> "list[tuple[Manifold, list[Facet]]]":
    """Cut a cell along the best plane; return the halves that are not empty, with the facets inside them."""
    plane = facets[_best_plane(facets, near)]
    below: list[Facet] = []
    above: list[Facet] = []
    for facet in facets:
        height = facet.corners @ plane.normal - plane.offset
        if np.abs(height).max() <= near:
            continue
        for side, sign in ((below, 1.0), (above, -1.0)):
            corners = _clipped(facet.corners, sign * height, near)
            if len(corners) > 2:
                side.append(facet._replace(corners=corners))
    up, down = cell.split_by_plane(plane.normal.tolist(), plane.offset)
    return [(half, inside) for half, inside in ((down, below), (up, above)) if not half.is_empty()]


def _best_plane(facets: list[Facet], near: float) -> int:
    """Return the number of the facet whose plane cuts fewest facets, and of these has most facets in it."""
    corners = np.concatenate([facet.corners for facet in facets])
    first = np.cumsum([0] + [len(facet.corners) for facet in facets])[:-1]
    height = corners @ np.array([facet.normal for facet in facets]).T - [facet.offset for facet in facets]
    low, high = np.minimum.reduceat(height, first), np.maximum.reduceat(height, first)
    cut = ((low < -near) & (high > near)).sum(axis=0)
    in_plane = ((low >= -near) & (high <= near)).sum(axis=0)
    return int(np.lexsort((-in_plane, cut))[0])


def _clipped(corners: Floats, height: Floats, near: float) -> Floats:
    """Return the part of a convex polygon with heights of at most 0; nothing if it only touches the plane."""
    if height.min() >= -near:
        return corners[:0]
    kept = []
    for k in range(len(corners)):
        following = (k + 1) % len(corners)
        a, b = height[k], height[following]
        if a <= near:
            kept.append(corners[k])
        if (a < -near and b > near) or (a > near and b < -near):
            kept.append(corners[k] + (corners[following] - corners[k]) * (a / (a - b)))
    return np.array(kept).reshape(-1, 3)


def winding_number(corners: Floats, point: Floats) -> float:
    """Return how often triangles ``(m, 3, 3)`` enclose a point: 1 inside a closed mesh, 0 outside."""
    a, b, c = (corners[:, k] - point for k in range(3))
    x, y, z = (np.linalg.norm(edge, axis=1) for edge in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a))]
    return float(
        np.arctan2(volume, x * y * z + dots[0] * z + dots[1] * x + dots[2] * y).sum() / (2.0 * np.pi)
    )


def _joined(cells: list[Floats], stop: Callable[[], bool]) -> list[Floats]:
    """Join two cells, again and again, while their hull adds no volume; the pair with the largest hull first."""
    pieces = dict(enumerate(extreme_points(cell) for cell in cells))
    volume = {k: hull_volume(piece) for k, piece in pieces.items()}
    allowed = 1e-6 * sum(volume.values())
    joints: dict[tuple[int, int], float] = {}
    for i in pieces:
        if stop():
            return list(pieces.values())
        joints |= _joints(i, [j for j in pieces if j < i], pieces, volume, allowed)
    number = len(cells)
    while joints and not stop():
        i, j = max(joints, key=lambda pair: (joints[pair], pair))
        pieces[number] = extreme_points(np.concatenate((pieces.pop(i), pieces.pop(j))))
        volume[number] = hull_volume(pieces[number])
        joints = {pair: value for pair, value in joints.items() if not {i, j} & set(pair)}
        joints |= _joints(number, [k for k in pieces if k != number], pieces, volume, allowed)
        number += 1
    return list(pieces.values())


def _joints(
    one: int, others: list[int], pieces: dict[int, Floats], volume: dict[int, float], allowed: float
) -> dict[tuple[int, int], float]:
    """Return the pairs of a piece with others that may be joined, with the volume of their hull; they touch."""
    found = {}
    low, high = pieces[one].min(axis=0), pieces[one].max(axis=0)
    near = NEAR * float(np.abs(pieces[one]).max())
    for other in others:
        apart = np.maximum(pieces[other].min(axis=0) - high, low - pieces[other].max(axis=0))
        if apart.max() > near:
            continue
        together = hull_volume(np.concatenate((pieces[one], pieces[other])))
        if together - volume[one] - volume[other] <= allowed:
            found[one, other] = together
    return found


def hull_volume(points: Floats) -> float:
    """Return the volume of the convex hull of points ``(n, 3)``; 0 if they are in one plane."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0
