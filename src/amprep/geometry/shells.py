"""Shells of a mesh: which are inside out, and the volume where the winding number is positive."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.geometry.merging import Bools, Floats, Ints

if TYPE_CHECKING:
    from manifold3d import Manifold


def label_shells(triangles: Ints, vertex_count: int) -> tuple[int, Ints]:
    """Return how many shells (triangles joined by vertices) there are, and each triangle's, ``(m,)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    start, end = triangles[:, [0, 1]].T.ravel(), triangles[:, [1, 2]].T.ravel()
    graph = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(vertex_count, vertex_count))
    _, label = connected_components(graph.tocsr(), directed=False)
    shells, of_triangle = np.unique(label[triangles[:, 0]], return_inverse=True)
    return len(shells), of_triangle.astype(np.int64)


def find_inside_out(vertices: Floats, triangles: Ints) -> tuple[Bools, int, int]:
    """Find shells that lie in no other shell and have negative volume, with all the shells inside them.

    Lying inside is judged by the boxes. A cavity is a shell of negative volume inside another: it stays.

    Returns
    -------
    turn
        ``(m,)`` whether a triangle has to be turned over.
    turned, shells
        How many outer shells that concerns, and how many shells there are.
    """
    count, shell = label_shells(triangles, len(vertices))
    corners = vertices[triangles]
    volume = _volumes(corners, shell, count)
    if (volume >= 0.0).all():
        return np.zeros(len(triangles), np.bool_), 0, count
    outer = _outermost(*_boxes(corners, shell, count))
    inside_out = volume[outer] < 0.0
    outermost = outer == np.arange(count)
    return inside_out[shell], int((inside_out & outermost).sum()), count


def solid_volume(solid: "Manifold") -> float:
    """Volume where the winding number is positive: shells that overlap count once, cavities are hollow.

    Of one self-intersecting shell the volume is the signed one.
    """
    shells = [shell for shell in solid.decompose() if not shell.is_empty()]
    cavities = [shell for shell in shells if shell.volume() < 0.0]
    if len(shells) < 2:
        return float(solid.volume())
    if not cavities:
        return float(_union(shells).volume())
    return _volume_with_cavities([shell for shell in shells if shell.volume() >= 0.0], cavities)


def _volume_with_cavities(outward: Sequence["Manifold"], cavities: Sequence["Manifold"]) -> float:
    """Volume of the points that lie in more outward shells than cavities."""
    from manifold3d import Manifold

    hollow = _levels([_turned(shell) for shell in cavities], len(outward))
    filled = _levels(outward, len(hollow) + 1)
    layers = [layer - hollow[depth] if depth < len(hollow) else layer for depth, layer in enumerate(filled)]
    return float(_union(layers).volume()) if layers else Manifold().volume()


def _levels(shells: Sequence["Manifold"], most: int) -> list["Manifold"]:
    """Return the sets of points inside at least 1, 2, ... of the shells, as far as not empty."""
    whole = _union(shells)
    if most < 2 or np.isclose(whole.volume(), sum(s.volume() for s in shells), rtol=1e-9):
        return [whole]
    half = len(shells) // 2
    return _merged(_levels(shells[:half], most), _levels(shells[half:], most), most)


def _merged(a: list["Manifold"], b: list["Manifold"], most: int) -> list["Manifold"]:
    """Return the levels of two families together: in i of the one and k - i of the other."""
    levels = []
    for k in range(1, min(len(a) + len(b), most) + 1):
        both = [a[i - 1] ^ b[k - i - 1] for i in range(1, k) if i <= len(a) and k - i <= len(b)]
        level = _union(a[k - 1 : k] + b[k - 1 : k] + both)
        if level.is_empty():
            break
        levels.append(level)
    return levels


def _union(solids: Sequence["Manifold"]) -> "Manifold":
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean(solids, OpType.Add)


def _turned(solid: "Manifold") -> "Manifold":
    """Return the solid with every triangle turned over."""
    from manifold3d import Manifold, Mesh64

    mesh = solid.to_mesh64()
    points = np.array(mesh.vert_properties[:, :3], order="C")
    return Manifold(Mesh64(points, np.array(mesh.tri_verts[:, ::-1], dtype=np.uint64, order="C")))


def _volumes(corners: Floats, shell: Ints, count: int) -> Floats:
    """Signed volume of each shell, measured from the shell's own corner; rounding counts as zero."""
    first = np.unique(shell, return_index=True)[1]
    local = corners - corners[first, 0][shell][:, None]
    parts = np.einsum("ij,ij->i", local[:, 0], np.cross(local[:, 1], local[:, 2])) / 6.0
    volume: Floats = np.bincount(shell, parts, count).astype(np.float64)
    volume[np.abs(volume) <= 1e-12 * np.bincount(shell, np.abs(parts), count)] = 0.0
    return volume


def _boxes(corners: Floats, shell: Ints, count: int) -> tuple[Floats, Floats]:
    """Least and greatest corner of each shell, ``(count, 3)``."""
    lo, hi = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(lo, shell, corners.min(axis=1))
    np.maximum.at(hi, shell, corners.max(axis=1))
    return lo, hi


def _outermost(lo: Floats, hi: Floats) -> Ints:
    """Return for each box the largest box that holds it, itself if there is none."""
    owner = np.full(len(lo), -1, np.int64)
    for box in np.argsort(-np.prod(hi - lo, axis=1), kind="stable"):
        if owner[box] < 0:
            inside = (lo >= lo[box]).all(axis=1) & (hi <= hi[box]).all(axis=1)
            owner[inside & (owner < 0)] = box
    return owner
