"""Unite whole prisms on arrays, without any Boolean."""

from functools import cache
from itertools import combinations, product

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.cells.tiling import expand
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import cancel_opposite, merge_vertices

# Strategy. A prism is one cube of the grid, upright or sheared by one step in x or in y. The sides of sheared prisms
# lie in the planes w = u and w = 1 - u of a voxel, where w is the height and u a horizontal coordinate. These four
# planes cut each voxel into the same fourteen convex fragments, so every prism is a union of fragments:
# an upright prism is a whole voxel, and an oblique one consists of the fragments in two quarters of the voxel below
# its upper square and in two quarters of the voxel above its lower square. The union of prisms is the set of their
# fragments, each counted once. All fragments have conforming faces, so that faces between two of them cancel, and
# what remains is the surface. Whole voxels are one template, with sides cut like those of the fragments. The cost is
# one sort of the faces.

_QUARTERS = ("bottom", "top", "left", "right")
"""Quarters of the square over one horizontal axis u and the height w, which both diagonals cut."""

_FRAGMENTS = [each for each in product(_QUARTERS, _QUARTERS) if set(each) != {"bottom", "top"}]
"""Quarters along x and along y that contain each fragment; `bottom` and `top` have no interior point in common."""

_WHOLE = len(_FRAGMENTS)
"""Number of the template that is a whole voxel."""

_UPPER_QUARTERS = {1: ("top", "right"), -1: ("top", "left")}
_LOWER_QUARTERS = {1: ("bottom", "left"), -1: ("bottom", "right")}
"""Quarters that a prism of step 1 or -1 fills in the voxel below its upper square, and above its lower square."""


def unite_prisms(square: Int64s, shift: Int64s, origin: Floats, size: Floats) -> MeshArrays:
    """Return the union of prisms as one closed mesh, rounded as a build file stores it.

    Parameters
    ----------
    square
        ``(n, 3)`` x, y, layer of the upper square of each prism.
    shift
        ``(n, 2)`` dx, dy from the upper square to the lower one: at most one step, in x or in y.
    origin, size
        ``(3,)`` mm: corner of the grid, and size of a voxel.
    """
    upright = (shift == 0).all(axis=1)
    whole = np.unique(square[upright], axis=0)
    filled = np.column_stack([whole, np.full(len(whole), _WHOLE)])
    fragments = np.unique(
        np.concatenate([np.empty((0, 4), np.int64), *_oblique_fragments(square, shift)]), axis=0
    )
    extent = np.concatenate([whole, fragments[:, :3]]).max(axis=0, initial=0) + 2
    inside = np.isin(_voxel_keys(fragments, extent), _voxel_keys(whole, extent))
    fragments = np.concatenate([filled, fragments[~inside]])
    matrix = np.zeros((len(fragments), 3, 4))
    matrix[:, [0, 1, 2], [0, 1, 2]] = size
    matrix[:, :, 3] = origin + fragments[:, :3] * size
    points, triangles, _ = expand(_templates(), fragments[:, 3], matrix)
    merged, corners = merge_vertices(points, triangles)
    return split_nonmanifold_edges(*drop_unused_vertices(merged, corners[cancel_opposite(corners)]))


def _voxel_keys(voxel: Int64s, extent: Int64s) -> Int64s:
    """Return a different number for each voxel (x, y, layer from -1 on)."""
    return np.asarray(((voxel[:, 2] + 1) * extent[1] + voxel[:, 1] + 1) * extent[0] + voxel[:, 0] + 1)


def _oblique_fragments(square: Int64s, shift: Int64s) -> list[Int64s]:
    """List the fragments ``(k, 4)`` x, y, layer, number of all oblique prisms."""
    found = []
    for axis, step in product((0, 1), (1, -1)):
        upper = square[shift[:, axis] == step]
        lower = upper.copy()
        lower[:, axis] += step
        for voxels, quarters in ((upper, _UPPER_QUARTERS[step]), (lower, _LOWER_QUARTERS[step])):
            for number, fragment in enumerate(_FRAGMENTS):
                if fragment[axis] in quarters:
                    found.append(np.column_stack([voxels, np.full(len(voxels), number)]))
    return found


@cache
def _templates() -> tuple[MeshArrays, ...]:
    """Return the fragments and the whole voxel as closed meshes."""
    corners = [tuple(float(each) for each in point) for point in product((0, 1), repeat=3)]
    sides = [(0.0, 0.5, 0.5), (1.0, 0.5, 0.5), (0.5, 0.0, 0.5), (0.5, 1.0, 0.5)]
    points = np.array([*corners, *sides, (0.5, 0.5, 0.5)])
    fragments = tuple(
        _hull(points[_in_quarter(points, 0, x) & _in_quarter(points, 1, y)]) for x, y in _FRAGMENTS
    )
    every = np.vstack([mesh[0] for mesh in fragments])
    offsets = np.cumsum([0] + [len(mesh[0]) for mesh in fragments[:-1]])
    triangles = np.vstack([mesh[1] + offset for mesh, offset in zip(fragments, offsets, strict=True)])
    merged, joined = merge_vertices(every, triangles)
    return *fragments, drop_unused_vertices(merged, joined[cancel_opposite(joined)])


def _in_quarter(points: Floats, axis: int, quarter: str) -> Bools:
    """Tell which points are in a closed quarter."""
    along, height = points[:, axis], points[:, 2]
    below, beyond = height <= along, height <= 1.0 - along
    above, before = height >= along, height >= 1.0 - along
    parts = {"bottom": below & beyond, "top": above & before, "left": above & beyond, "right": below & before}
    return np.asarray(parts[quarter])


def _hull(points: Floats) -> MeshArrays:
    """Return the convex hull of a few points. Horizontal squares are cut along the diagonal from (0, 0) to (1, 1)."""
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
