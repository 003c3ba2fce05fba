"""Unite cells of all directions on arrays: each pattern of cells that share a voxel once, the voxels side to side."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.merging.nonmanifold_edges import crowded_ends, halved, part_at
from amprep.geometry.merging.voxel_contents import LATTICE, SIDES, Piece, Pieces
from amprep.geometry.meshes.topology import degenerate
from amprep.geometry.meshes.welding import label_equal_rows


class Voxels(NamedTuple):
    """Voxels of the grid that hold something.

    Attributes
    ----------
    place
        ``(n, 3)`` x, y, layer.
    piece
        ``(n,)`` number of what each holds.
    """

    place: Int64s
    piece: Int64s


class _Facing(NamedTuple):
    """Which of the six sides of each voxel keep their surface ``(n, 6)``; what sides come to that differ.

    Attributes
    ----------
    voxel, axis, ours, theirs
        ``(k,)`` a voxel and the axis on whose far side the outlines `ours` and `theirs` (numbers) meet.
    """

    keep: Bools
    voxel: Int64s
    axis: Int64s
    ours: Int64s
    theirs: Int64s


class _Seams(NamedTuple):
    """Copies of what two sides come to: corners ``(s, 3)`` on the lattice, triangles, splits (see `Seam`)."""

    corners: Int64s
    triangles: Int64s
    splits: Int64s


class _Copies(NamedTuple):
    """Where copies of a piece go: voxels ``(n,)`` by number; where their inner points and triangles begin."""

    piece: Piece
    voxel: Int64s
    point: int
    triangle: int


class _Soup(NamedTuple):
    """Triangles at the sides of voxels; corners count the inner points first, then those that others may share.

    Attributes
    ----------
    shared
        ``(s, 3)`` steps of the lattice from the grid's origin; several at each place.
    near, rim
        Triangles with one shared corner, and with more.
    splits
        ``(r, 3)`` corners: edges and what they pass through.
    """

    shared: Int64s
    near: Int64s
    rim: Int64s
    splits: Int64s


def join_cells(
    pieces: Pieces, template: Int64s, square: Int64s, shift: Int64s, origin: Floats, size: Floats
) -> tuple[Floats, Int64s] | None:
    """Return the union of cells as one closed mesh; None where it cannot be made on arrays.

    Cells are cut where they pass from one voxel of the grid into the next, what shares a voxel is united, each
    pattern of it once, and sides that face each other keep what the other does not cover.

    Parameters
    ----------
    template, square, shift
        As for `fill_voxels`.
    origin, size
        ``(3,)`` mm, of the grid and of its voxels.
    """
    return join_voxels(pieces, fill_voxels(pieces, template, square, shift), origin, size)


def fill_voxels(pieces: Pieces, template: Int64s, square: Int64s, shift: Int64s) -> Voxels:
    """Sort cells into the voxels they pass through.

    Parameters
    ----------
    template
        ``(n,)`` of `pieces`.
    square
        ``(n, 3)`` x, y, layer of each cell's upper square.
    shift
        ``(n, 2)`` dx, dy to its lower square: at most one step, in x or in y.
    """
    _, first, kind = np.unique(
        9 * template + 3 * shift[:, 0] + shift[:, 1], return_index=True, return_inverse=True
    )
    held = [pieces.item(int(template[each]), tuple(shift[each].tolist())) for each in first]
    items = np.array(held, np.int64).reshape(-1, 2)
    far = items[kind, 1] >= 0
    lower = square[far] + np.column_stack([shift[far], np.zeros(int(far.sum()), np.int64)])
    place = np.concatenate([square, lower])
    item = np.concatenate([items[kind, 0], items[kind[far], 1]])
    low, extent = place.min(axis=0), np.ptp(place, axis=0) + 1
    voxel = (place - low) @ np.array([1, extent[0], extent[0] * extent[1]])
    count = len(pieces.items)
    voxel, item = np.divmod(np.unique(voxel * count + item), count)
    starts = np.flatnonzero(np.diff(voxel, prepend=-1))
    sizes = np.diff(np.append(starts, len(voxel)))
    piece = np.empty(len(starts), np.int64)
    alone = sizes == 1
    for each in np.unique(item[starts[alone]]):
        piece[alone & (item[starts] == each)] = pieces.piece(np.array([each]))
    for index in np.flatnonzero(~alone):
        piece[index] = pieces.piece(item[starts[index] : starts[index] + sizes[index]])
    number = voxel[starts]
    place = np.column_stack(
        [number % extent[0], number // extent[0] % extent[1], number // extent[0] // extent[1]]
    )
    return Voxels(low + place, piece)


def join_voxels(pieces: Pieces, voxels: Voxels, origin: Floats, size: Floats) -> tuple[Floats, Int64s] | None:
    """Return what voxels hold as one closed mesh; None where it cannot be joined on arrays.

    Parameters
    ----------
    origin, size
        ``(3,)`` mm, of the grid and of its voxels.
    """
    facing = _face(pieces, voxels)
    seams = _placed_seams(pieces, voxels, facing)
    if seams is None:
        return None
    copies = _copies(pieces, voxels)
    inner, closed = copies[-1].point, copies[-1].triangle
    every = sum(len(each.voxel) * sum(map(len, each.piece.parts)) for each in copies)
    outer = sum(len(each.voxel) * (len(each.piece.points) - each.piece.inner) for each in copies)
    points = np.empty((inner + outer + sum(len(seam.corners) for seam in seams), 3))
    triangles = np.empty((every + sum(len(seam.triangles) for seam in seams), 3), np.int32)
    with ThreadPoolExecutor(1) as pool:
        filling = pool.submit(_fill, copies, voxels.place, origin, size, points, triangles)
        shared, near, rim = _joined(_at_sides(copies, voxels, facing, seams), inner)
        crowded = crowded_ends(rim, inner)
        filling.result()
    if crowded is None:
        return None
    last = inner + len(shared)
    points[inner:last] = origin + shared * (size / LATTICE)
    added, rim = part_at(points[:last], np.concatenate([near, rim]), crowded)
    used = np.zeros(last + len(added), np.bool_)
    used[rim] = True
    _renumber(rim, inner, np.cumsum(used[inner:]) - 1)
    rest = np.concatenate([points[inner:last], added])[used[inner:]]
    return _appended(points, inner, rest), _appended(triangles, closed, rim)


def _copies(pieces: Pieces, voxels: Voxels) -> list[_Copies]:
    """List which voxels hold each piece, and behind them where inner points and triangles end."""
    used, which, count = np.unique(voxels.piece, return_inverse=True, return_counts=True)
    order = np.split(np.argsort(which, kind="stable"), np.cumsum(count)[:-1])
    listed: list[_Copies] = []
    point = triangle = 0
    for number, voxel in zip(used.tolist(), order, strict=True):
        piece = pieces.made[number]
        listed.append(_Copies(piece, voxel, point, triangle))
        point += len(voxel) * piece.inner
        triangle += len(voxel) * len(piece.parts[0])
    return [*listed, _Copies(piece, order[0][:0], point, triangle)]


def _fill(
    copies: list[_Copies],
    place: Int64s,
    origin: Floats,
    size: Floats,
    points: Floats,
    triangles: NDArray[np.int32],
) -> None:
    """Write inner points, and triangles of these alone; the bulk of the work, and done beside the rest."""
    for (piece, voxel, point, triangle), after in pairwise(copies):
        into = points[point : after.point].reshape(len(voxel), -1, 3)
        moved = (origin + place[voxel] * size)[:, None]
        np.add((piece.points[: piece.inner] * (size / LATTICE))[None], moved, out=into)
        starts = (point + piece.inner * np.arange(len(voxel), dtype=np.int32))[:, None, None]
        faces = triangles[triangle : after.triangle].reshape(len(voxel), -1, 3)
        np.add(piece.parts[0][None].astype(np.int32), starts.astype(np.int32), out=faces)


def _at_sides(copies: list[_Copies], voxels: Voxels, facing: _Facing, seams: list[_Seams]) -> _Soup:
    """Copy what lies at the sides of voxels, and between them what differing sides come to."""
    shared, near, rim = [], [], []
    first = copies[-1].point
    for piece, voxel, point, _ in copies[:-1]:
        sides = piece.points[piece.inner :]
        shared.append((sides[None] + voxels.place[voxel][:, None] * LATTICE).reshape(-1, 3))
        number = np.arange(len(voxel))
        starts = np.column_stack([point + piece.inner * number, first - piece.inner + len(sides) * number])
        near.append(_copied(piece.parts[1], piece.inner, starts))
        rim.append(_copied(piece.parts[2], piece.inner, starts))
        rim += [
            _copied(piece.parts[3 + side], piece.inner, starts[facing.keep[voxel, side]]) for side in SIDES
        ]
        first += len(sides) * len(voxel)
    return _Soup(
        np.concatenate([*shared, *(seam.corners for seam in seams)]),
        np.concatenate(near),
        np.concatenate([*rim, *(seam.triangles + first for seam in seams)]),
        np.concatenate([np.empty((0, 3), np.int64), *(seam.splits + first for seam in seams)]),
    )


def _joined(soup: _Soup, inner: int) -> tuple[Int64s, Int64s, Int64s]:
    """Make shared corners at the same place one, and split edges at the corners that lie on them.

    Returns
    -------
    shared, near, rim
        Each place once; triangles as in the soup.
    """
    label, count = label_equal_rows(soup.shared)
    shared = np.empty((count, 3), np.int64)
    shared[label] = soup.shared
    _renumber(soup.near, inner, label)
    _renumber(soup.rim, inner, label)
    rim = _at_splits(soup.rim, inner + label[soup.splits - inner], inner + count)
    return shared, soup.near, _at_lines(rim, shared, inner)


def _renumber(triangles: Int64s, first: int, number: Int64s) -> None:
    """Give corners from `first` on their new numbers, in place."""
    flat = triangles.reshape(-1)
    outer = np.flatnonzero(flat >= first)
    flat[outer] = first + number[flat[outer] - first]


def _appended(room: NDArray[Any], count: int, rows: NDArray[Any]) -> NDArray[Any]:
    """Put rows after the first ones, in place where there is room."""
    if count + len(rows) > len(room):
        return np.concatenate([room[:count], rows])
    room[count : count + len(rows)] = rows
    return room[: count + len(rows)]


def _face(pieces: Pieces, voxels: Voxels) -> _Facing:
    """Look at what each voxel's far sides face."""
    keep = np.ones((len(voxels.place), 6), np.bool_)
    outlines = np.array([piece.outlines for piece in pieces.made], np.int64)[voxels.piece]
    low = voxels.place.min(axis=0)
    extent = voxels.place.max(axis=0) - low + 2
    step = np.array([1, extent[0], extent[0] * extent[1]])
    key = (voxels.place - low) @ step
    order = np.argsort(key)
    differing = []
    for axis in range(3):
        at = np.minimum(np.searchsorted(key[order], key + step[axis]), len(key) - 1)
        voxel = np.flatnonzero(key[order][at] == key + step[axis])
        other = order[at[voxel]]
        ours, theirs = outlines[voxel, 2 * axis + 1], outlines[other, 2 * axis]
        meet = (ours > 0) & (theirs > 0)
        keep[voxel[meet], 2 * axis + 1] = keep[other[meet], 2 * axis] = False
        differ = meet & (ours != theirs)
        differing.append([voxel[differ], np.full(int(differ.sum()), axis), ours[differ], theirs[differ]])
    return _Facing(keep, *(np.concatenate(column) for column in zip(*differing, strict=True)))


def _placed_seams(pieces: Pieces, voxels: Voxels, facing: _Facing) -> list[_Seams] | None:
    """Put what differing sides come to between the voxels; None where some do not come to anything."""
    rows = np.column_stack([facing.axis, facing.ours, facing.theirs])
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    placed: list[_Seams] = []
    first = 0
    for number, (axis, ours, theirs) in enumerate(kinds.tolist()):
        found = pieces.seam(ours, theirs)
        if found is None:
            return None
        place = voxels.place[facing.voxel[kind.reshape(-1) == number]]
        corners = np.empty((len(found.points), 3), np.int64)
        corners[:, axis], corners[:, [(axis + 1) % 3, (axis + 2) % 3]] = LATTICE, found.points
        starts = (first + len(corners) * np.arange(len(place)))[:, None, None]
        triangles = np.concatenate([found.ours, found.theirs[:, ::-1]])
        copies = (
            corners[None] + place[:, None] * LATTICE,
            triangles[None] + starts,
            found.splits[None] + starts,
        )
        placed.append(_Seams(*(each.reshape(-1, 3) for each in copies)))
        first += len(corners) * len(place)
    return placed


def _copied(triangles: Int64s, inner: int, starts: Int64s) -> Int64s:
    """Copy triangles; their inner and outer corners count from different `starts` ``(n, 2)``."""
    outer = (triangles >= inner).astype(np.int64)
    return (triangles[None] + starts[:, outer]).reshape(-1, 3)


def _at_splits(triangles: Int64s, splits: Int64s, count: int) -> Int64s:
    """Split triangles whose edges are known to pass through a point."""
    if not len(splits):
        return triangles
    ends = np.sort(splits[:, :2], axis=1)
    key, first = np.unique(ends[:, 0] * count + ends[:, 1], return_index=True)
    through = splits[first, 2]
    hot = np.zeros(count, np.bool_)
    hot[splits[:, :2]] = True

    def middle(start: Int64s, end: Int64s) -> Int64s:
        wanted = np.minimum(start, end) * count + np.maximum(start, end)
        at = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        return np.where(key[at] == wanted, through[at], -1)

    return _halved_until_none(triangles, hot, middle)


def _at_lines(triangles: Int64s, shared: Int64s, first: int) -> Int64s:
    """Split triangles whose edges run along a line of the grid, at all corners there are on it.

    Up to four voxels meet in such a line, and each two of them know of their own corners only.
    """
    used = np.zeros(len(shared), np.bool_)
    used[triangles[triangles >= first] - first] = True
    on_plane = shared % LATTICE == 0
    for axis in range(3):
        others = [(axis + 1) % 3, (axis + 2) % 3]
        here = np.flatnonzero(used & on_plane[:, others].all(axis=1))
        order = here[np.lexsort((shared[here, axis], *shared[here][:, others].T))]
        if not len(order):
            continue
        rank, line = np.full(len(shared), -1), np.full(len(shared), -1)
        rank[order] = np.arange(len(order))
        new = (shared[order[1:]][:, others] != shared[order[:-1]][:, others]).any(axis=1)
        line[order] = np.cumsum(np.concatenate([[0], new]))

        def middle(
            start: Int64s, end: Int64s, rank: Int64s = rank, line: Int64s = line, order: Int64s = order
        ) -> Int64s:
            outer = np.minimum(start, end) >= first
            start, end = np.maximum(start - first, 0), np.maximum(end - first, 0)
            between = np.abs(rank[start] - rank[end]) > 1
            along = outer & (line[start] == line[end]) & (line[start] >= 0) & between
            half = (rank[start] + rank[end]) // 2
            return np.where(along, first + order[np.where(along, half, 0)], -1)

        hot = np.concatenate([np.zeros(first, np.bool_), line >= 0])
        triangles = _halved_until_none(triangles, hot, middle)
    return triangles


def _halved_until_none(triangles: Int64s, hot: Bools, middle: Callable[[Int64s, Int64s], Int64s]) -> Int64s:
    """Split triangles at the middles of their edges, and what comes of it, until no edge has any.

    Parameters
    ----------
    hot
        Which points an edge with a middle may begin and end at.
    middle
        Gives the points on edges from start to end, -1 for none.
    """
    done = []
    while len(triangles):
        likely = hot[triangles].sum(axis=1) > 1
        done.append(triangles[~likely])
        triangles = triangles[likely]
        middles = np.column_stack(
            [middle(triangles[:, a], triangles[:, b]) for a, b in ((0, 1), (1, 2), (2, 0))]
        )
        open_ = (middles >= 0).any(axis=1)
        done.append(triangles[~open_])
        triangles = halved(triangles[open_], middles[open_])
        triangles = triangles[~degenerate(triangles)]  # of slivers whose third corner the edge passes through
    return np.concatenate([*done, triangles])
