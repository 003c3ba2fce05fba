"""Find support sections that overlap, and flat faces in which finished cells meet without cancelling."""

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.welding import label_equal_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_FLUSH = 1e-6
"""Share of a cube: triangles this close to a plane lie in it."""

_PLANES = (
    ((1, 0, 0), (1, 2)), ((0, 1, 0), (0, 2)), ((0, 0, 1), (0, 1)),
    ((1, 0, 1), (1, 2)), ((1, 0, -1), (1, 2)), ((0, 1, 1), (0, 2)), ((0, 1, -1), (0, 2)),
)  # fmt: skip
"""The planes in which prisms meet: normals, in units of cubes, and the two axes that place a point in the plane."""


def find_overlaps(square: Ints, shift: Ints, kind: Ints) -> Ints:
    """Find pairs of sections whose prisms overlap, ``(k, 2)``.

    At height w above its lower square a section's cross-section has moved by (1 - w) of its shift: two of a
    layer overlap when at some height their squares are less than 1 apart in x and in y.

    Parameters
    ----------
    square, shift
        ``(n, 3)`` x, y, layer of the upper square and ``(n, 2)`` dx, dy to the lower one.
    kind
        ``(n,)`` 0 or 1: two sections in the same place overlap when they are of different kinds.
    """
    if len(square) == 0:
        return np.empty((0, 2), np.int64)
    place = square - square.min(axis=0) + (2, 2, 0)
    extent = place.max(axis=0) + 3
    direction = kind * 9 + (shift[:, 0] + 1) * 3 + shift[:, 1] + 1
    key = _packed(place, extent) * 18 + direction
    order = np.argsort(key)
    pairs = [np.empty((0, 2), np.int64)]
    directions = np.unique(direction).tolist()
    for this, other in ((a, b) for a in directions for b in directions):
        mine = np.flatnonzero(direction == this)
        for x, y in _overlapping_offsets(this, other):
            sought = _packed(place[mine] + (x, y, 0), extent) * 18 + other
            at = np.minimum(np.searchsorted(key, sought, sorter=order), len(key) - 1)
            hit = key[order[at]] == sought
            pairs.append(np.column_stack([mine[hit], order[at[hit]]]))
    return np.concatenate(pairs)


def _packed(place: Ints, extent: Ints) -> Ints:
    return np.asarray((place[:, 2] * extent[1] + place[:, 1]) * extent[0] + place[:, 0])


def _overlapping_offsets(this: int, other: int) -> list[tuple[int, int]]:
    """Offsets (x, y) at which a section of direction `other` overlaps one of direction `this`."""
    drift = np.array(divmod(other % 9, 3)) - divmod(this % 9, 3)
    moved = np.linspace(0.001, 0.999, 9)[:, None] * drift
    reach = range(-2, 3)
    found = [(x, y) for x in reach for y in reach if (np.abs(moved + (x, y)) < 1.0).all(axis=1).any()]
    return [offset for offset in found if this != other or offset != (0, 0)]


def find_meetings(corners: Floats, source: Ints) -> Ints:
    """Find pairs of meshes that have triangles on both sides of the same piece of a plane, ``(k, 2)``.

    A piece is a unit square of a plane in which prisms meet, so that meshes are reported that come near each
    other there and do not touch: but never fewer than do.

    Parameters
    ----------
    corners
        ``(m, 3, 3)`` in units of cubes, what cancelling left over.
    source
        ``(m,)`` which mesh each triangle belongs to.
    """
    pairs = [np.empty((0, 2), np.int64)]
    for normal, axes in _PLANES:
        height = corners @ np.array(normal, np.float64)
        plane = np.round(height[:, 0])
        flat = np.flatnonzero((np.abs(height - plane[:, None]) < _FLUSH).all(axis=1))
        sides = corners[flat, 1:] - corners[flat, :1]
        upward = np.cross(sides[:, 0], sides[:, 1]) @ np.array(normal, np.float64) > 0.0
        pieces, of_triangle = _pieces(corners[flat][:, :, axes])
        pieces = np.column_stack([pieces, plane[flat[of_triangle]].astype(np.int64)])
        pairs.append(_facing(pieces, upward[of_triangle], source[flat[of_triangle]]))
    return np.unique(np.concatenate(pairs), axis=0)


def _pieces(corners: Floats) -> tuple[Ints, Ints]:
    """Unit squares that the boxes of triangles ``(m, 3, 2)`` reach into, ``(k, 2)``, and whose they are."""
    low = np.floor(corners.min(axis=1) + _FLUSH).astype(np.int64)
    high = np.ceil(corners.max(axis=1) - _FLUSH).astype(np.int64) - 1
    spans = int((high - low).max(initial=0)) + 1
    pieces, owners = [np.empty((0, 2), np.int64)], [np.empty(0, np.int64)]
    for step in ((a, b) for a in range(spans) for b in range(spans)):
        reached = np.flatnonzero((low + step <= high).all(axis=1))
        pieces.append(low[reached] + step)
        owners.append(reached)
    return np.concatenate(pieces), np.concatenate(owners)


def _facing(pieces: Ints, upward: NDArray[np.bool_], source: Ints) -> Ints:
    """Pair the meshes of each piece with the first one there, where some face up and some down."""
    piece, count = label_equal_rows(pieces)
    both = (np.bincount(piece, upward, count) > 0) & (np.bincount(piece, ~upward, count) > 0)
    chosen = np.flatnonzero(both[piece])
    first = np.zeros(count, np.int64)
    first[piece[chosen[::-1]]] = source[chosen[::-1]]
    pairs = np.column_stack([first[piece[chosen]], source[chosen]])
    return pairs[pairs[:, 0] != pairs[:, 1]]
