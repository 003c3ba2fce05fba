"""Join whole prisms without any boolean: the planes of their sides cut each voxel into the same fourteen pieces."""

from functools import cache
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.cells.tiling import expand
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import cancel_opposite, merge_vertices

_QUARTERS = ("bottom", "top", "left", "right")
"""Of the square across one horizontal axis u and height w, cut along both diagonals: below, above, left, right."""

_PIECES = [each for each in product(_QUARTERS, _QUARTERS) if set(each) != {"bottom", "top"}]
"""Quarter along x and along y; `bottom` and `top` have no height in common."""

_WHOLE = len(_PIECES)
"""Number of the piece that is a whole voxel, its upright sides cut in quarters like those of the others."""

_REACHES = {0: (), 1: ("top", "right"), -1: ("top", "left")}
_ARRIVES = {1: ("bottom", "left"), -1: ("bottom", "right")}
"""Quarters that a prism fills in the voxel below its upper square, and in the one above its lower square."""


def unite_prisms(square: Int64s, shift: Int64s, origin: Floats, size: Floats) -> MeshArrays:
    """Return the union of prisms as one closed mesh, as a build file keeps it.

    Parameters
    ----------
    square
        ``(n, 3)`` x, y, layer of each prism's upper square.
    shift
        ``(n, 2)`` dx, dy to its lower square: at most one step, in x or in y.
    origin, size
        ``(3,)`` mm, of the grid and of its voxels.
    """
    upright = (shift == 0).all(axis=1)
    whole = np.unique(square[upright], axis=0)
    filled = np.column_stack([whole, np.full(len(whole), _WHOLE)])
    pieces = np.unique(np.concatenate([np.empty((0, 4), np.int64), *_sheared(square, shift)]), axis=0)
    extent = np.concatenate([whole, pieces[:, :3]]).max(axis=0, initial=0) + 2
    inside = np.isin(_packed(pieces, extent), _packed(whole, extent))
    pieces = np.concatenate([filled, pieces[~inside]])
    matrix = np.zeros((len(pieces), 3, 4))
    matrix[:, [0, 1, 2], [0, 1, 2]] = size
    matrix[:, :, 3] = origin + pieces[:, :3] * size
    points, triangles, _ = expand(_templates(), pieces[:, 3], matrix)
    merged, corners = merge_vertices(points, triangles)
    return split_nonmanifold_edges(*drop_unused_vertices(merged, corners[cancel_opposite(corners)]))


def _packed(voxel: Int64s, extent: Int64s) -> Int64s:
    return np.asarray(((voxel[:, 2] + 1) * extent[1] + voxel[:, 1] + 1) * extent[0] + voxel[:, 0] + 1)


def _sheared(square: Int64s, shift: Int64s) -> list[Int64s]:
    """List the pieces ``(k, 4)`` x, y, layer, piece of all prisms that are not upright."""
    found = []
    for axis, step in product((0, 1), (1, -1)):
        upper = square[shift[:, axis] == step]
        lower = upper.copy()
        lower[:, axis] += step
        for voxels, quarters in ((upper, _REACHES[step]), (lower, _ARRIVES[step])):
            for number, piece in enumerate(_PIECES):
                if piece[axis] in quarters:
                    found.append(np.column_stack([voxels, np.full(len(voxels), number)]))
    return found


@cache
def _templates() -> tuple[MeshArrays, ...]:
    """Return the pieces and the whole voxel as closed meshes."""
    corners = [tuple(float(each) for each in point) for point in product((0, 1), repeat=3)]
    sides = [(0.0, 0.5, 0.5), (1.0, 0.5, 0.5), (0.5, 0.0, 0.5), (0.5, 1.0, 0.5)]
    points = np.array([*corners, *sides, (0.5, 0.5, 0.5)])
    pieces = tuple(_hull(points[_in_quarter(points, 0, x) & _in_quarter(points, 1, y)]) for x, y in _PIECES)
    every = np.vstack([mesh[0] for mesh in pieces])
    offsets = np.cumsum([0] + [len(mesh[0]) for mesh in pieces[:-1]])
    triangles = np.vstack([mesh[1] + offset for mesh, offset in zip(pieces, offsets, strict=True)])
    merged, joined = merge_vertices(every, triangles)
    return *pieces, drop_unused_vertices(merged, joined[cancel_opposite(joined)])


def _in_quarter(points: Floats, axis: int, quarter: str) -> NDArray[np.bool_]:
    """Which points lie in a closed quarter."""
    along, height = points[:, axis], points[:, 2]
    below, beyond = height <= along, height <= 1.0 - along
    above, before = height >= along, height >= 1.0 - along
    parts = {"bottom": below & beyond, "top": above & before, "left": above & beyond, "right": below & before}
    return np.asarray(parts[quarter])


def _hull(points: Floats) -> MeshArrays:
    """Return the convex hull of a few points: triangles, and level squares cut along one diagonal."""
    centre = points.mean(axis=0)
    triangles = []
    for a, b, c in combinations(range(len(points)), 3):
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        away = (points - points[a]) @ normal
        if not ((away <= 0.0).all() or (away >= 0.0).all()) or not normal.any():
            continue
        plan = points[[a, b, c], :2]
        if (away == 0.0).sum() == 4 and not {(0.0, 0.0), (1.0, 1.0)} <= set(map(tuple, plan.tolist())):
            continue
        outward = (points[a] - centre) @ normal > 0.0
        triangles.append([a, b, c] if outward else [a, c, b])
    return points, np.array(triangles, np.int64)
