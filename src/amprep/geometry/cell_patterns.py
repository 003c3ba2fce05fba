"""Patterns: clusters of support sections that are alike, and their union in units of cubes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.cell_solids import stable_union
from amprep.geometry.cell_tiling import Arrays, Tiles, tile
from amprep.geometry.merging import compact
from amprep.geometry.solids import as_manifold
from amprep.geometry.welding import cancel_opposite, merge_vertices

if TYPE_CHECKING:
    from manifold3d import Manifold

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

Pattern = tuple[tuple[int, ...], ...]
"""Rows (template, x, y, layer, dx, dy, kind), sorted, counted from the pattern's corner."""

_LEVEL = 1e-7
"""Share of a cube: closer than this is the same place."""


def find_patterns(
    template: Ints, square: Ints, shift: Ints, kind: Ints, cluster: Ints
) -> tuple[list[Pattern], Ints, Ints]:
    """Find equal clusters.

    Returns
    -------
    patterns
        The different ones, in order of first appearance.
    pattern, corner
        ``(k,)`` of each cluster, and its least x, y and layer ``(k, 3)``.
    """
    rows = np.column_stack([template, square, shift, kind])
    order = np.lexsort((*rows.T, cluster))
    rows, cluster = rows[order], cluster[order]
    begins = np.flatnonzero(np.diff(cluster, prepend=-1))
    sizes = np.diff(np.append(begins, len(rows)))
    corner = np.minimum.reduceat(rows[:, 1:4], begins, axis=0)
    rows[:, 1:4] -= np.repeat(corner, sizes, axis=0)
    number: dict[bytes, int] = {}
    patterns: list[Pattern] = []
    pattern = np.empty(len(begins), np.int64)
    for i, (begin, size) in enumerate(zip(begins.tolist(), sizes.tolist(), strict=True)):
        members = rows[begin : begin + size]
        pattern[i] = number.setdefault(members.tobytes(), len(patterns))
        if pattern[i] == len(patterns):
            patterns.append(tuple(map(tuple, members.tolist())))
    return patterns, pattern, corner


def unite(templates: Sequence[Arrays], pattern: Pattern) -> Arrays:
    """Return the union of a pattern's cells as a closed mesh in units of cubes, from its corner.

    Flat ends of a pattern of one layer get the triangles of the cells' own ends, so that they cancel with
    what stands on them.
    """
    rows = np.array(pattern, np.int64)
    template, square, shift = rows[:, 0], rows[:, 1:4], rows[:, 4:6]
    matrix = np.zeros((len(rows), 3, 4))
    matrix[:, [0, 1, 2], [0, 1, 2]] = 1.0
    matrix[:, :2, 2] = -shift
    matrix[:, :, 3] = square
    matrix[:, :2, 3] += shift
    if len(rows) == 1:
        points, triangles = templates[template[0]]
        return points @ matrix[0, :, :3].T + matrix[0, :, 3], triangles
    place = square.copy()
    place[:, :2] += shift * square[:, 2:]
    solids: list[Manifold] = []
    for each in np.unique(rows[:, 4:], axis=0):
        same = (rows[:, 4:] == each).all(axis=1)
        tiles = Tiles(template[same], place[same], matrix[same])
        solids += [as_manifold(*mesh) for mesh in tile(templates, tiles)]
    whole = stable_union(solids, _LEVEL)
    if square[:, 2].any():
        return whole
    return _with_own_ends(whole, [_moved(templates[i], each) for i, each in zip(template, matrix, strict=True)])


def _moved(mesh: Arrays, matrix: Floats) -> Arrays:
    return mesh[0] @ matrix[:, :3].T + matrix[:, 3], mesh[1]


def _with_own_ends(whole: Arrays, cells: Sequence[Arrays]) -> Arrays:
    """Replace the triangles at the bottom, and those at the top, by those of the cells where that closes."""
    for height in (0.0, 1.0):
        parts = [(whole[0], whole[1][~_at(whole, height)])]
        parts += [(points, triangles[_at((points, triangles), height)]) for points, triangles in cells]
        whole = _put_together(parts) or whole
    return whole


def _put_together(parts: Sequence[Arrays]) -> Arrays | None:
    """Return the parts as one mesh, or None if that is not closed."""
    offsets = np.cumsum([0] + [len(points) for points, _ in parts[:-1]])
    points = np.vstack([points for points, _ in parts])
    triangles = np.vstack([each + offset for (_, each), offset in zip(parts, offsets, strict=True)])
    _, corners = merge_vertices(points, triangles, lattice=10 * _LEVEL)
    stays = cancel_opposite(corners)
    corners = corners[stays]
    if not _is_closed(corners):
        return None
    place = np.empty((int(corners.max()) + 1, 3))
    place[corners] = points[triangles[stays]]
    return compact(place, corners)


def _at(mesh: Arrays, height: float) -> Bools:
    """Which triangles lie in one end of the layer."""
    return np.asarray((np.abs(mesh[0][mesh[1], 2] - height) < _LEVEL).all(axis=1))


def _is_closed(triangles: Ints) -> bool:
    """Whether every edge is run along as often forth as back."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    base = int(triangles.max(initial=0)) + 1
    return bool(np.array_equal(np.sort(start * base + end), np.sort(end * base + start)))
