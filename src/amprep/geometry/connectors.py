"""Connectors: from red squares straight up to the true surface that they hold, and a little into it."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.cell_edges import separate_edges
from amprep.geometry.cell_solids import arrays_of, union
from amprep.geometry.solids import as_manifold
from amprep.geometry.welding import kept, weld
from amprep.kernels import cells as kernels

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Arrays = tuple[Floats, Ints]

RUN_SLACK = 1e-6
"""mm; faces this little outside a column's run of cubes still count as in it."""


class Columns(NamedTuple):
    """The spaces above red squares that connectors may pass.

    Attributes
    ----------
    lo, hi
        ``(m, 3)`` mm, from the red square up to the top of its run of cubes.
    square
        ``(m, 2)`` int64, y and x.
    grid
        ``(3,)`` origin x, origin y, pitch.
    shape
        Numbers of squares (ny, nx).
    """

    lo: Floats
    hi: Floats
    square: Ints
    grid: Floats
    shape: tuple[int, int]


class Patches(NamedTuple):
    """Pieces of triangles that lie in columns, sorted by column.

    Attributes
    ----------
    points
        ``(p, 3)`` mm, corners, counter-clockwise seen from above.
    start
        ``(n + 1,)`` where each patch's corners start.
    owner
        ``(n, 2)`` column, and triangle as the caller numbers them.
    of_column
        ``(m + 1,)`` where each column's patches start.
    """

    points: Floats
    start: Ints
    owner: Ints
    of_column: Ints

    def chosen(self, keep: Bools) -> "Patches":
        """Return only the patches that `keep` ``(n,)`` names."""
        sizes = np.diff(self.start)
        start = np.concatenate([[0], np.cumsum(sizes[keep])])
        owner = self.owner[keep]
        of_column = np.searchsorted(owner[:, 0], np.arange(len(self.of_column)))
        return Patches(self.points[np.repeat(keep, sizes)], start, owner, of_column)


    def alone(self, index: int) -> "Patches":
        """Return one patch."""
        begin, end = self.start[index], self.start[index + 1]
        one = np.array([0, end - begin])
        return Patches(self.points[begin:end], one, self.owner[index : index + 1], one[:1])


def clip_into(columns: Columns, corners: Floats, number: Ints, allowed: Bools) -> Patches:
    """Cut triangles that look down to the columns they reach into.

    Parameters
    ----------
    corners
        ``(t, 3, 3)`` mm.
    number
        ``(t,)`` what each triangle is called in `Patches.owner`.
    allowed
        ``(m,)`` which columns to fill.
    """
    ny, nx = columns.shape
    chosen = np.flatnonzero(allowed)
    flat = columns.square[chosen, 0] * nx + columns.square[chosen, 1]
    order = np.argsort(flat, kind="stable")
    square_start = np.searchsorted(flat[order], np.arange(ny * nx + 1))
    room = 4 * len(corners) + 64
    while True:
        points, start, owner = np.empty((8 * room, 3)), np.empty(room + 1, np.int64), np.empty((room, 2), np.int64)
        count = kernels.clip_into_columns(
            corners, columns.grid, columns.shape, square_start, chosen[order], columns.lo, columns.hi,
            RUN_SLACK, points, start, owner,
        )  # fmt: skip
        if count >= 0:
            break
        room *= 4
    owner = owner[:count]
    owner[:, 1] = number[owner[:, 1]]
    return _sorted(points, start[: count + 1], owner, len(columns.lo))


def _sorted(points: Floats, start: Ints, owner: Ints, columns: int) -> Patches:
    """Sort patches by column."""
    order = np.argsort(owner[:, 0], kind="stable")
    sizes = np.diff(start)[order]
    ends = np.cumsum(sizes)
    take = np.repeat(start[:-1][order] - ends + sizes, sizes) + np.arange(int(sizes.sum()))
    owner = owner[order]
    of_column = np.searchsorted(owner[:, 0], np.arange(columns + 1))
    return Patches(points[take], np.concatenate([[0], ends]), owner, of_column)


def join_patches(families: Sequence[Patches], columns: int) -> Patches:
    """Return the patches of several families as one."""
    points = np.concatenate([np.empty((0, 3)), *(each.points for each in families)])
    sizes = np.concatenate([np.empty(0, np.int64), *(np.diff(each.start) for each in families)])
    owner = np.concatenate([np.empty((0, 2), np.int64), *(each.owner for each in families)])
    return _sorted(points, np.concatenate([[0], np.cumsum(sizes)]), owner, columns)


def held_corners(
    vertices: Floats, triangles: Ints, faces: Ints, edges: Ints, tips: Ints, *, width: float
) -> Floats:
    """Return what is to be held as triangles that look down, ``(t, 3, 3)`` mm.

    A face is itself; a knife edge is a level band of `width` mm along it, a tip a level square of that width.

    Parameters
    ----------
    faces, edges, tips
        Triangles, ``(e, 2)`` and ``(t,)`` vertices.
    """
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along = end - start
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    length = np.linalg.norm(across, axis=1)
    across *= (0.5 * width / np.maximum(length, 1e-12))[:, None]
    x, y = np.eye(3)[:2] * width
    middle = vertices[tips]
    bands = _quads(np.concatenate([start - across, middle - 0.5 * (x + y)]),
                   np.concatenate([start + across, middle + 0.5 * (y - x)]),
                   np.concatenate([end + across, middle + 0.5 * (x + y)]),
                   np.concatenate([end - across, middle + 0.5 * (x - y)]))  # fmt: skip
    return np.concatenate([vertices[triangles[faces]], bands])


def _quads(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Two triangles for each quadrangle given by its corners ``(n, 3)``."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def square_patches(columns: Columns, chosen: Ints) -> Patches:
    """Return the bottoms of some columns as patches."""
    lo, hi = columns.lo[chosen], columns.hi[chosen]
    corners = [np.column_stack([x[:, 0], y[:, 1], lo[:, 2]]) for x, y in ((lo, lo), (hi, lo), (hi, hi), (lo, hi))]
    owner = np.column_stack([chosen, chosen])
    of_column = np.searchsorted(chosen, np.arange(len(columns.lo) + 1))
    return Patches(np.stack(corners, axis=1).reshape(-1, 3), 4 * np.arange(len(chosen) + 1), owner, of_column)


def find_covered(held: Patches, surface: Patches) -> Bools:
    """Tell in which columns something held has another face of the parts below it, ``(m,)``."""
    covered = np.zeros(len(held.of_column) - 1, np.bool_)
    kernels.find_covered(
        held.points, held.start, held.owner, held.of_column,
        surface.points, surface.start, surface.owner, surface.of_column, covered,
    )  # fmt: skip
    return covered


def connect(
    columns: Columns, held: Patches, surface: Patches, *, base: Floats, overlap: float, own: Bools
) -> list[Arrays]:
    """Fill the columns from the red squares up to the held faces, `overlap` mm into them.

    Where another face lies below a held one it comes first: nothing passes it.

    Parameters
    ----------
    columns, held, surface
        `surface` is all that looks down, of any part, held or not.
    base
        ``(m,)`` mm, where the connectors of each column begin.
    overlap
        mm, more than `RUN_SLACK`.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column holds; other parts are
        not touched.

    Returns
    -------
    meshes
        Closed ones that may touch one another: two of all columns where nothing is in the way, such that
        within one no two columns lie side by side; and one for each other column.
    """
    covered = find_covered(held, surface)
    free = ~covered[held.owner[:, 0]]
    colour = columns.square.sum(axis=1)[held.owner[:, 0]] % 2
    meshes = []
    for chosen in (free & (colour == 0), free & (colour == 1)):
        if chosen.any():
            part = held.chosen(chosen)
            meshes.append(separate_edges(*prisms(part, base[part.owner[:, 0]], overlap)))
    return meshes + list(_covered_ways(columns, held, surface, covered, base, overlap, own))


def prisms(patches: Patches, level: Floats, rise: float | Floats) -> Arrays:
    """Return the prisms between the patches, raised by `rise`, and the levels below or above them.

    Neighbouring prisms share no walls: what both have cancels.

    Parameters
    ----------
    level
        ``(n,)`` mm, the height of each prism's flat end.
    rise
        mm, one for all or ``(n,)``.
    """
    sizes = np.diff(patches.start)
    count = len(patches.points)
    sloped, flat = patches.points.copy(), patches.points.copy()
    sloped[:, 2] += np.repeat(np.broadcast_to(rise, sizes.shape), sizes)
    flat[:, 2] = np.repeat(level, sizes)
    top, bottom = (0, count) if sloped[:, 2].sum() >= flat[:, 2].sum() else (count, 0)
    first = np.repeat(patches.start[:-1], sizes)
    here = np.arange(count)
    following = np.where(here + 1 == np.repeat(patches.start[1:], sizes), first, here + 1)
    inner = (here != first) & (following != first)
    fans = np.column_stack([first, here, following])[inner]
    points = kept(np.vstack([sloped, flat]))
    # a wall is cut along the same diagonal from both sides
    forth = _lexicographic_less(points[here], points[following])
    wall_a = np.where(forth[:, None], np.column_stack([here + bottom, following + bottom, following + top]),
                      np.column_stack([here + bottom, following + bottom, here + top]))  # fmt: skip
    wall_b = np.where(forth[:, None], np.column_stack([here + bottom, following + top, here + top]),
                      np.column_stack([following + bottom, following + top, here + top]))  # fmt: skip
    triangles = np.concatenate([fans + top, fans[:, ::-1] + bottom, wall_a, wall_b])
    return weld(points, triangles, lattice=0.0)


def _lexicographic_less(a: Floats, b: Floats) -> Bools:
    """Whether a comes before b by x, then by y, ``(n,)``."""
    return np.asarray((a[:, 0] < b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] < b[:, 1])))


def _covered_ways(
    columns: Columns,
    held: Patches,
    surface: Patches,
    covered: Bools,
    base: Floats,
    overlap: float,
    own: Bools,
) -> Iterator[Arrays]:
    """Yield what is left of each covered column below the first face met."""
    lid = columns.hi[:, 2] + 2.0 * overlap
    for column in np.flatnonzero(covered):
        wanted = _each(held, column, base, overlap)
        blocked = _each(surface, column, lid, np.where(own, overlap, -overlap))
        way = union([as_manifold(*mesh) for mesh in wanted])
        way = way - union([as_manifold(*mesh) for mesh in blocked])
        if not way.is_empty():
            yield arrays_of(way)


def _each(patches: Patches, column: int, level: Floats, rise: float | Floats) -> Iterator[Arrays]:
    """Yield the prism of every patch of a column."""
    rises = np.broadcast_to(rise, (len(patches.owner),))
    for index in range(patches.of_column[column], patches.of_column[column + 1]):
        yield prisms(patches.alone(index), level[column : column + 1], rises[index])
