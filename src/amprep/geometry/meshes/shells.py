"""Shells of a mesh: orientation, and the volume where the winding number is positive."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.manifold import as_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold

MAX_UNITED = 20_000
"""Largest number of overlapping shells that are united (this takes minutes); of more, overlaps count repeatedly."""

_MOST_PAIRS = 50_000_000


class Shells(NamedTuple):
    """The shells of a mesh: sets of triangles connected by edges.

    Attributes
    ----------
    label
        ``(m,)`` shell of each triangle, 0 to k - 1.
    volume
        ``(k,)`` signed volume, mm3; rounding errors are set to zero.
    lo, hi
        ``(k, 3)`` mm, corners of the bounding boxes.
    may_overlap
        ``(k,)`` whether a shell may overlap another or itself, so that volumes cannot be added.
    """

    label: Int64s
    volume: Floats
    lo: Floats
    hi: Floats
    may_overlap: Bools


def label_shells(triangles: Int64s, vertex_count: int) -> tuple[int, Int64s]:
    """Return the number of components (triangles connected by vertices), and that of each triangle, ``(m,)``."""
    from amprep.kernels.meshes.components import join_corners

    lowest = np.arange(vertex_count)
    join_corners(np.ascontiguousarray(triangles, np.int64), lowest)
    label = lowest[triangles[:, 0]]
    used = np.zeros(vertex_count, np.bool_)
    used[label] = True
    return int(used.sum()), (np.cumsum(used) - 1)[label]


def measure_shells(vertices: Floats, triangles: Int64s) -> Shells:
    """Find and measure the shells of a mesh whose edges match."""
    count, label, simple = _join_by_edges(triangles)
    corners = vertices[triangles]
    lo, hi = _boxes(corners, label, count)
    may_overlap = ~simple | _overlapping(lo, hi)
    return Shells(label, _volumes(corners, label, count), lo, hi, may_overlap)


def find_inside_out(shells: Shells) -> tuple[Bools, int]:
    """Find shells of negative volume that are inside no other shell, and all shells inside these.

    A shell of negative volume inside another one is a cavity and remains. Containment is judged by bounding boxes.

    Returns
    -------
    turn
        ``(k,)`` whether the orientation of a shell must be reversed.
    outer
        Number of these shells that are inside no other.
    """
    if (shells.volume >= 0.0).all():
        return np.zeros(len(shells.volume), np.bool_), 0
    outer = _outermost(shells.lo, shells.hi)
    turn = shells.volume[outer] < 0.0
    return turn, int((turn & (outer == np.arange(len(outer)))).sum())


def solid_volume(vertices: Floats, triangles: Int64s, shells: Shells) -> float:
    """Return the volume where the winding number is positive, mm3: overlaps count once, cavities are empty.

    A single shell that intersects itself counts with its signed volume.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    shells
        Shells of the mesh.
    """
    may_overlap = shells.may_overlap
    alone = float(shells.volume[~may_overlap].clip(min=0.0).sum())
    if not may_overlap.any():
        return alone
    if may_overlap.sum() > MAX_UNITED:
        return alone + max(0.0, float(shells.volume[may_overlap].sum()))
    pieces = [
        piece
        for shell in _split(triangles[may_overlap[shells.label]], shells.label[may_overlap[shells.label]])
        for piece in _manifold_of(vertices, shell).decompose()
    ]
    outward = [piece for piece in pieces if piece.volume() > 0.0]
    cavities = [piece for piece in pieces if piece.volume() < 0.0]
    if not cavities:
        return alone + float(_union(outward).volume())
    return alone + _volume_with_cavities(outward, cavities)


def _manifold_of(vertices: Floats, triangles: Int64s) -> "Manifold":
    used, corners = np.unique(triangles, return_inverse=True)
    return as_manifold(vertices[used], corners.reshape(-1, 3))


def _join_by_edges(triangles: Int64s) -> tuple[int, Int64s, Bools]:
    """Return the number of shells, that of each triangle, and which shells have two triangles at every edge."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    keys = np.minimum(start, end) * (int(triangles.max()) + 1) + np.maximum(start, end)
    order = np.argsort(keys, kind="stable")
    same = keys[order[1:]] == keys[order[:-1]]
    owner = order // 3
    one, other = owner[:-1][same], owner[1:][same]
    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(len(triangles),) * 2)
    count, label = connected_components(graph, directed=False)
    simple = np.ones(count, np.bool_)
    simple[label[owner[1:-1][same[1:] & same[:-1]]]] = False
    return count, label.astype(np.int64), simple


def _split(triangles: Int64s, label: Int64s) -> list[Int64s]:
    """Return the triangles of each label, ascending."""
    order = np.argsort(label, kind="stable")
    return np.split(triangles[order], np.flatnonzero(np.diff(label[order])) + 1)


def _overlapping(lo: Floats, hi: Floats) -> Bools:
    """Tell which boxes meet another one; all of them where there are too many pairs to look at."""
    if len(lo) == 1:
        return np.zeros(1, np.bool_)
    sweeps = [_sweep(lo, hi, axis) for axis in range(3)]
    order, last = min(sweeps, key=lambda sweep: int(sweep[1].sum()))
    ahead = last - np.arange(len(last)) - 1
    if ahead.sum() > _MOST_PAIRS:
        return np.ones(len(lo), np.bool_)
    first = np.repeat(np.arange(len(last)), ahead)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(ahead) - ahead, ahead)
    one, other = order[first], order[second]
    meet = ((lo[one] <= hi[other]) & (lo[other] <= hi[one])).all(axis=1)
    result = np.zeros(len(lo), np.bool_)
    result[one[meet]] = result[other[meet]] = True
    return result


def _sweep(lo: Floats, hi: Floats, axis: int) -> tuple[Int64s, Int64s]:
    """Order boxes along an axis; return the order, and for each place the end of the boxes it reaches."""
    order = np.argsort(lo[:, axis], kind="stable")
    return order, np.searchsorted(lo[order, axis], hi[order, axis], side="right")


def _volume_with_cavities(outward: Sequence["Manifold"], cavities: Sequence["Manifold"]) -> float:
    """Return the volume of the points that are inside more outward shells than cavities."""
    from manifold3d import Manifold

    hollow = _levels([_turned(shell) for shell in cavities], len(outward))
    filled = _levels(outward, len(hollow) + 1)
    layers = [layer - hollow[depth] if depth < len(hollow) else layer for depth, layer in enumerate(filled)]
    return float(_union(layers).volume()) if layers else Manifold().volume()


def _levels(shells: Sequence["Manifold"], most: int) -> list["Manifold"]:
    """Return the sets of points inside at least 1, 2, ... shells, as long as they are not empty."""
    whole = _union(shells)
    if most < 2 or np.isclose(whole.volume(), sum(s.volume() for s in shells), rtol=1e-9):
        return [whole]
    half = len(shells) // 2
    return _merged(_levels(shells[:half], most), _levels(shells[half:], most), most)


def _merged(a: list["Manifold"], b: list["Manifold"], most: int) -> list["Manifold"]:
    """Return the levels of two families together: level k is the union of level i and level k - i over all i."""
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
    """Return the solid with every triangle reversed."""
    mesh = solid.to_mesh64()
    return as_manifold(mesh.vert_properties[:, :3], mesh.tri_verts[:, ::-1])


def _volumes(corners: Floats, shell: Int64s, count: int) -> Floats:
    """Return the signed volume of each shell relative to one of its corners; rounding errors are set to zero."""
    first = np.unique(shell, return_index=True)[1]
    local = corners - corners[first, 0][shell][:, None]
    parts = np.einsum("ij,ij->i", local[:, 0], np.cross(local[:, 1], local[:, 2])) / 6.0
    volume: Floats = np.bincount(shell, parts, count).astype(np.float64)
    volume[np.abs(volume) <= 1e-12 * np.bincount(shell, np.abs(parts), count)] = 0.0
    return volume


def _boxes(corners: Floats, shell: Int64s, count: int) -> tuple[Floats, Floats]:
    """Return the least and greatest corner of each shell, ``(count, 3)``."""
    lo, hi = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(lo, shell, corners.min(axis=1))
    np.maximum.at(hi, shell, corners.max(axis=1))
    return lo, hi


def _outermost(lo: Floats, hi: Floats) -> Int64s:
    """Return for each box the largest box that contains it, itself if there is none."""
    owner = np.full(len(lo), -1, np.int64)
    for box in np.argsort(-np.prod(hi - lo, axis=1), kind="stable"):
        if owner[box] < 0:
            inside = (lo >= lo[box]).all(axis=1) & (hi <= hi[box]).all(axis=1)
            owner[inside & (owner < 0)] = box
    return owner
