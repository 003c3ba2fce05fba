"""Weld cells of one direction, which tile space, to closed meshes."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import cancel_opposite, merge_vertices

_FLUSH = 1e-9
"""Distance, in edges of the unit cube, within which a corner counts as on a side."""


class Tiles(NamedTuple):
    """Cells of one direction: copies of templates, each in its own tile of a lattice.

    Attributes
    ----------
    template
        ``(n,)`` numbers of templates.
    place
        ``(n, 3)`` int64, integer coordinates of the tile along the axes of the unit cube. Cells with a common side
        differ by 1 in one coordinate.
    matrix
        ``(n, 3, 4)`` unit cube to build coordinates.
    """

    template: Int64s
    place: Int64s
    matrix: Floats


def fills_unit_cube(points: Floats) -> bool:
    """Tell whether all points are in the unit cube."""
    return bool((points > -_FLUSH).all() and (points < 1.0 + _FLUSH).all())


def plate(thickness: float) -> MeshArrays:
    """Return a plate below the top of the unit cube, as wide as the cube; its thickness is a fraction of the height."""
    corners = [[x, y, z] for z in (1.0 - thickness, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
    triangles = [
        [0, 2, 3], [0, 3, 1], [4, 7, 6], [4, 5, 7], [0, 1, 5], [0, 5, 4],
        [2, 7, 3], [2, 6, 7], [0, 4, 6], [0, 6, 2], [1, 7, 5], [1, 3, 7],
    ]  # fmt: skip
    return np.array(corners), np.array(triangles, np.int64)


def expand(
    templates: Sequence[MeshArrays], template: Int64s, matrix: Floats
) -> tuple[Floats, Int64s, Int64s]:
    """Copy templates under their maps.

    Parameters
    ----------
    templates
        Meshes in the unit cube.
    template, matrix
        ``(n,)`` template of each copy, and ``(n, 3, 4)`` its map.

    Returns
    -------
    points, triangles
        ``(k, 3)`` mm, not merged, and ``(m, 3)``.
    source
        ``(m,)`` copy to which each triangle belongs.
    """
    points, triangles, source = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], [np.empty(0, np.int64)]
    first = 0
    for index, (corners, faces) in enumerate(templates):
        copies = np.flatnonzero(template == index)
        moved = np.einsum("nij,vj->nvi", matrix[copies, :, :3], corners) + matrix[copies, None, :, 3]
        offsets = first + len(corners) * np.arange(len(copies))
        points.append(moved.reshape(-1, 3))
        triangles.append((faces[None] + offsets[:, None, None]).reshape(-1, 3))
        source.append(np.repeat(copies, len(faces)))
        first += len(copies) * len(corners)
    return np.vstack(points), np.vstack(triangles), np.concatenate(source)


def tile(templates: Sequence[MeshArrays], tiles: Tiles) -> Iterator[MeshArrays]:
    """Yield closed meshes whose union is the union of the cells: one mesh if neighbours conform, else two.

    If neighbours have different triangles on a common side, cells are coloured like a chessboard, and each colour
    becomes one mesh. Cells of the same colour have no common side.

    Parameters
    ----------
    templates
        Closed meshes in the unit cube.
    tiles
        Cells of one direction.
    """
    welded, conform = _weld(templates, tiles)
    if conform:
        yield welded
        return
    colour = tiles.place.sum(axis=1) % 2
    for chosen in (colour == 0, colour == 1):
        if chosen.any():
            yield _weld(templates, Tiles(*(column[chosen] for column in tiles)))[0]


def _weld(templates: Sequence[MeshArrays], tiles: Tiles) -> tuple[MeshArrays, bool]:
    """Weld all cells; tell whether all triangles on common sides cancelled."""
    points, triangles, source = expand(templates, tiles.template, tiles.matrix)
    merged, corners = merge_vertices(points, triangles)
    stays = cancel_opposite(corners)
    side = _sides(templates, tiles.template)[stays]
    conform = not _facing(tiles.place[source[stays]], side)
    return split_nonmanifold_edges(*drop_unused_vertices(merged, corners[stays])), conform


def _sides(templates: Sequence[MeshArrays], template: Int64s) -> Int64s:
    """Return the side of the unit cube that contains each expanded triangle: 2 axis + (0 or 1), or -1."""
    sides = [np.empty(0, np.int64)]
    for index, (corners, faces) in enumerate(templates):
        low = (np.abs(corners[faces]) < _FLUSH).all(axis=1)
        high = (np.abs(corners[faces] - 1.0) < _FLUSH).all(axis=1)
        flush = np.stack([low, high], axis=2).reshape(len(faces), 6)
        side = np.where(flush.any(axis=1), flush.argmax(axis=1), -1)
        sides.append(np.tile(side, int((template == index).sum())))
    return np.concatenate(sides)


def _facing(place: Int64s, side: Int64s) -> bool:
    """Tell whether some side between two cells has triangles of both cells."""
    flush = side >= 0
    axis, far = np.divmod(side[flush], 2)
    between = place[flush].copy()
    between[np.arange(len(between)), axis] += far
    if len(between) == 0:
        return False
    between -= between.min(axis=0)
    extent = between.max(axis=0) + 1
    key = (between @ np.array([extent[1] * extent[2], extent[2], 1])) * 3 + axis
    return bool(np.intersect1d(key[far == 0], key[far == 1]).size)
