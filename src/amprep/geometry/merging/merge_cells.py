"""Unite cells of all directions on arrays: each pattern of cells that share a cube once, the cubes side to side."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.merging.nonmanifold_edges import crowded_ends, halved, part_at
from amprep.geometry.merging.voxel_contents import LATTICE, SIDES, Piece, Pieces
from amprep.geometry.meshes.topology import degenerate
from amprep.geometry.meshes.welding import label_equal_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Cubes(NamedTuple):
    """Cubes of the grid that hold something.

    Attributes
    ----------
    place
        ``(n, 3)`` x, y, layer.
    piece
        ``(n,)`` number of what each holds.
    """

    place: Ints
    piece: Ints


class _Facing(NamedTuple):
    """Which of the six sides of each cube keep their surface ``(n, 6)``; what sides come to that differ.

    Attributes
    ----------
    cube, axis, ours, theirs
        ``(k,)`` a cube and the axis on whose far side the outlines `ours` and `theirs` (numbers) meet.
    """

    keep: Bools
    cube: Ints
    axis: Ints
    ours: Ints
    theirs: Ints


class _Seams(NamedTuple):
    """Copies of what two sides come to: corners ``(s, 3)`` on the lattice, triangles, splits (see `Seam`)."""

    corners: Ints
    triangles: Ints
    splits: Ints


class _Copies(NamedTuple):
    """Where copies of a piece go: cubes ``(n,)`` by number; where their inner points and triangles begin."""

    piece: Piece
    cube: Ints
    point: int
    triangle: int


class _Soup(NamedTuple):
    """Triangles at the sides of cubes; corners count the inner points first, then those that others may share.

    Attributes
    ----------
    shared
        ``(s, 3)`` steps of the lattice from the grid's origin; several at each place.
    near, rim
        Triangles with one shared corner, and with more.
    splits
        ``(r, 3)`` corners: edges and what they pass through.
    """

    shared: Ints
    near: Ints
    rim: Ints
    splits: Ints


def join_cells(
    pieces: Pieces, template: Ints, square: Ints, shift: Ints, origin: Floats, size: Floats
) -> tuple[Floats, Ints] | None:
    """Return the union of cells as one closed mesh; None where it cannot be made on arrays.

    Cells are cut where they pass from one cube of the grid into the next, what shares a cube is united, each
    pattern of it once, and sides that face each other keep what the other does not cover.

    Parameters
    ----------
    template, square, shift
        As for `fill_cubes`.
    origin, size
        ``(3,)`` mm, of the grid and of its cubes.
    """
    return join_cubes(pieces, fill_cubes(pieces, template, square, shift), origin, size)


def fill_cubes(pieces: Pieces, template: Ints, square: Ints, shift: Ints) -> Cubes:
    """Sort cells into the cubes they pass through.

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
    cube = (place - low) @ np.array([1, extent[0], extent[0] * extent[1]])
    count = len(pieces.items)
    cube, item = np.divmod(np.unique(cube * count + item), count)
    starts = np.flatnonzero(np.diff(cube, prepend=-1))
    sizes = np.diff(np.append(starts, len(cube)))
    piece = np.empty(len(starts), np.int64)
    alone = sizes == 1
    for each in np.unique(item[starts[alone]]):
        piece[alone & (item[starts] == each)] = pieces.piece(np.array([each]))
    for index in np.flatnonzero(~alone):
        piece[index] = pieces.piece(item[starts[index] : starts[index] + sizes[index]])
    number = cube[starts]
    place = np.column_stack(
        [number % extent[0], number // extent[0] % extent[1], number // extent[0] // extent[1]]
    )
    return Cubes(low + place, piece)


def join_cubes(pieces: Pieces, cubes: Cubes, origin: Floats, size: Floats) -> tuple[Floats, Ints] | None:
    """Return what cubes hold as one closed mesh; None where it cannot be joined on arrays.

    Parameters
    ----------
    origin, size
        ``(3,)`` mm, of the grid and of its cubes.
    """
    facing = _face(pieces, cubes)
    seams = _placed_seams(pieces, cubes, facing)
    if seams is None:
        return None
    copies = _copies(pieces, cubes)
    inner, closed = copies[-1].point, copies[-1].triangle
    every = sum(len(each.cube) * sum(map(len, each.piece.parts)) for each in copies)
    outer = sum(len(each.cube) * (len(each.piece.points) - each.piece.inner) for each in copies)
    points = np.empty((inner + outer + sum(len(seam.corners) for seam in seams), 3))
    triangles = np.empty((every + sum(len(seam.triangles) for seam in seams), 3), np.int32)
    with ThreadPoolExecutor(1) as pool:
        filling = pool.submit(_fill, copies, cubes.place, origin, size, points, triangles)
        shared, near, rim = _joined(_at_sides(copies, cubes, facing, seams), inner)
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


def _copies(pieces: Pieces, cubes: Cubes) -> list[_Copies]:
    """List which cubes hold each piece, and behind them where inner points and triangles end."""
    used, which, count = np.unique(cubes.piece, return_inverse=True, return_counts=True)
    order = np.split(np.argsort(which, kind="stable"), np.cumsum(count)[:-1])
    listed: list[_Copies] = []
    point = triangle = 0
    for number, cube in zip(used.tolist(), order, strict=True):
        piece = pieces.made[number]
        listed.append(_Copies(piece, cube, point, triangle))
        point += len(cube) * piece.inner
        triangle += len(cube) * len(piece.parts[0])
    return [*listed, _Copies(piece, order[0][:0], point, triangle)]


def _fill(
    copies: list[_Copies],
    place: Ints,
    origin: Floats,
    size: Floats,
    points: Floats,
    triangles: NDArray[np.int32],
) -> None:
    """Write inner points, and triangles of these alone; the bulk of the work, and done beside the rest."""
    for (piece, cube, point, triangle), after in pairwise(copies):
        into = points[point : after.point].reshape(len(cube), -1, 3)
        moved = (origin + place[cube] * size)[:, None]
        np.add((piece.points[: piece.inner] * (size / LATTICE))[None], moved, out=into)
        starts = (point + piece.inner * np.arange(len(cube), dtype=np.int32))[:, None, None]
        faces = triangles[triangle : after.triangle].reshape(len(cube), -1, 3)
        np.add(piece.parts[0][None].astype(np.int32), starts.astype(np.int32), out=faces)


def _at_sides(copies: list[_Copies], cubes: Cubes, facing: _Facing, seams: list[_Seams]) -> _Soup:
    """Copy what lies at the sides of cubes, and between them what differing sides come to."""
    shared, near, rim = [], [], []
    first = copies[-1].point
    for piece, cube, point, _ in copies[:-1]:
        sides = piece.points[piece.inner :]
        shared.append((sides[None] + cubes.place[cube][:, None] * LATTICE).reshape(-1, 3))
        number = np.arange(len(cube))
        starts = np.column_stack([point + piece.inner * number, first - piece.inner + len(sides) * number])
        near.append(_copied(piece.parts[1], piece.inner, starts))
        rim.append(_copied(piece.parts[2], piece.inner, starts))
        rim += [
            _copied(piece.parts[3 + side], piece.inner, starts[facing.keep[cube, side]]) for side in SIDES
        ]
        first += len(sides) * len(cube)
    return _Soup(
        np.concatenate([*shared, *(seam.corners for seam in seams)]),
        np.concatenate(near),
        np.concatenate([*rim, *(seam.triangles + first for seam in seams)]),
        np.concatenate([np.empty((0, 3), np.int64), *(seam.splits + first for seam in seams)]),
    )


def _joined(soup: _Soup, inner: int) -> tuple[Ints, Ints, Ints]:
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


def _renumber(triangles: Ints, first: int, number: Ints) -> None:
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


def _face(pieces: Pieces, cubes: Cubes) -> _Facing:
    """Look at what each cube's far sides face."""
    keep = np.ones((len(cubes.place), 6), np.bool_)
    outlines = np.array([piece.outlines for piece in pieces.made], np.int64)[cubes.piece]
    low = cubes.place.min(axis=0)
    extent = cubes.place.max(axis=0) - low + 2
    step = np.array([1, extent[0], extent[0] * extent[1]])
    key = (cubes.place - low) @ step
    order = np.argsort(key)
    differing = []
    for axis in range(3):
        at = np.minimum(np.searchsorted(key[order], key + step[axis]), len(key) - 1)
        cube = np.flatnonzero(key[order][at] == key + step[axis])
        other = order[at[cube]]
        ours, theirs = outlines[cube, 2 * axis + 1], outlines[other, 2 * axis]
        meet = (ours > 0) & (theirs > 0)
        keep[cube[meet], 2 * axis + 1] = keep[other[meet], 2 * axis] = False
        differ = meet & (ours != theirs)
        differing.append([cube[differ], np.full(int(differ.sum()), axis), ours[differ], theirs[differ]])
    return _Facing(keep, *(np.concatenate(column) for column in zip(*differing, strict=True)))


def _placed_seams(pieces: Pieces, cubes: Cubes, facing: _Facing) -> list[_Seams] | None:
    """Put what differing sides come to between the cubes; None where some do not come to anything."""
    rows = np.column_stack([facing.axis, facing.ours, facing.theirs])
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    placed: list[_Seams] = []
    first = 0
    for number, (axis, ours, theirs) in enumerate(kinds.tolist()):
        found = pieces.seam(ours, theirs)
        if found is None:
            return None
        place = cubes.place[facing.cube[kind.reshape(-1) == number]]
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


def _copied(triangles: Ints, inner: int, starts: Ints) -> Ints:
    """Copy triangles; their inner and outer corners count from different `starts` ``(n, 2)``."""
    outer = (triangles >= inner).astype(np.int64)
    return (triangles[None] + starts[:, outer]).reshape(-1, 3)


def _at_splits(triangles: Ints, splits: Ints, count: int) -> Ints:
    """Split triangles whose edges are known to pass through a point."""
    if not len(splits):
        return triangles
    ends = np.sort(splits[:, :2], axis=1)
    key, first = np.unique(ends[:, 0] * count + ends[:, 1], return_index=True)
    through = splits[first, 2]
    hot = np.zeros(count, np.bool_)
    hot[splits[:, :2]] = True

    def middle(start: Ints, end: Ints) -> Ints:
        wanted = np.minimum(start, end) * count + np.maximum(start, end)
        at = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        return np.where(key[at] == wanted, through[at], -1)

    return _halved_until_none(triangles, hot, middle)


def _at_lines(triangles: Ints, shared: Ints, first: int) -> Ints:
    """Split triangles whose edges run along a line of the grid, at all corners there are on it.

    Up to four cubes meet in such a line, and each two of them know of their own corners only.
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

        def middle(start: Ints, end: Ints, rank: Ints = rank, line: Ints = line, order: Ints = order) -> Ints:
            outer = np.minimum(start, end) >= first
            start, end = np.maximum(start - first, 0), np.maximum(end - first, 0)
            between = np.abs(rank[start] - rank[end]) > 1
            along = outer & (line[start] == line[end]) & (line[start] >= 0) & between
            half = (rank[start] + rank[end]) // 2
            return np.where(along, first + order[np.where(along, half, 0)], -1)

        hot = np.concatenate([np.zeros(first, np.bool_), line >= 0])
        triangles = _halved_until_none(triangles, hot, middle)
    return triangles


def _halved_until_none(triangles: Ints, hot: Bools, middle: Callable[[Ints, Ints], Ints]) -> Ints:
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
