"""Connectors: from red squares straight up to the true surface that they hold, and a little into it."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.merging.nonmanifold_edges import separate_edges
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.repair import as_manifold
from amprep.geometry.meshes.welding import kept, label_equal_rows, weld
from amprep.kernels.meshes import clip_columns as kernels
from amprep.kernels.meshes import patches as patch_kernels

if TYPE_CHECKING:
    from manifold3d import Manifold

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Arrays = tuple[Floats, Ints]

RUN_SLACK = 1e-6
"""mm; faces this little outside a column's run of cubes still count as in it."""

CROWDED = 64
"""In columns with more patches than this below others, those that are hidden are left out."""

_SAMPLES = 64
"""Points per side of a column's content: a patch seen from below only between them counts as hidden."""

_LOWEST = 1e-4
"""mm; walls are not cut closer than this to their upper ends."""


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

    def in_column(self, column: int) -> tuple[Floats, Ints]:
        """Return the corners of the patches in a column, and where each patch's start among them."""
        first, last = self.of_column[column : column + 2]
        start = self.start[first : last + 1]
        return self.points[start[0] : start[-1]], start - start[0]


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
        points, start, owner = (
            np.empty((8 * room, 3)),
            np.empty(room + 1, np.int64),
            np.empty((room, 2), np.int64),
        )
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


def find_covered(held: Patches, surface: Patches) -> Bools:
    """Tell in which columns something held has another face of the parts below it, ``(m,)``."""
    covered = np.zeros(len(held.of_column) - 1, np.bool_)
    covered[surface.owner[find_below(held, surface), 0]] = True
    return covered


def find_below(held: Patches, surface: Patches) -> Bools:
    """Tell which patches of `surface` lie below, at least in part, another that is held, ``(n,)``."""
    below = np.zeros(len(surface.owner), np.bool_)
    patch_kernels.find_below(
        held.points, held.start, held.owner, held.of_column,
        surface.points, surface.start, surface.owner, surface.of_column, below,
    )  # fmt: skip
    return below


def connect(
    held: Patches, surface: Patches, *, base: Floats, lid: Floats, overlap: float, own: Bools
) -> list[Arrays]:
    """Fill columns from the red squares up to the held faces, `overlap` mm into them.

    Where another face lies below a held one it comes first: nothing passes it.

    Parameters
    ----------
    held, surface
        Pieces in the columns; `surface` is all that looks down, of any part, held or not.
    base, lid
        ``(m,)`` mm, where the connectors of each column begin, and a height that none of them reaches.
    overlap
        mm, more than `RUN_SLACK`.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column holds; other parts are
        not touched.

    Returns
    -------
    meshes
        Closed ones that may touch one another: of all columns where nothing is in the way one for each surface
        that hangs together, and one for each other column. Surfaces that only touch in plan stay apart: the
        walls between them lie in each other, and manifold3d joins them without fault, but tidies them badly.
    """
    rise = np.where(own, overlap, -overlap)
    held, below = _without_hidden(held, surface, find_below(held, surface), overlap, rise)
    cutting, rise = surface.chosen(below), rise[below]
    covered = np.diff(cutting.of_column) > 0
    free = held.chosen(~covered[held.owner[:, 0]])
    meshes = []
    surface_of = _label_surfaces(free)
    for each in range(int(surface_of.max(initial=-1)) + 1):
        whole = free.chosen(surface_of == each)
        meshes.append(separate_edges(*stand_on(whole, base[whole.owner[:, 0]], overlap)))
    for column in np.flatnonzero(covered).tolist():
        way = union(list(_prisms(*held.in_column(column), overlap, base[column])))
        first, last = cutting.of_column[column : column + 2]
        way -= union(list(_prisms(*cutting.in_column(column), rise[first:last], lid[column], hang=True)))
        if not way.is_empty():
            meshes.append(arrays_of(way))
    return meshes


def _label_surfaces(patches: Patches) -> Ints:
    """Number the surfaces that patches form where they share whole edges, ``(n,)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(patches.owner)
    corner, _ = label_equal_rows(kept(patches.points).view(np.int64))
    patch = np.repeat(np.arange(count), np.diff(patches.start))
    here = np.arange(len(corner))
    after = np.where(here + 1 == patches.start[1:][patch], patches.start[:-1][patch], here + 1)
    ends = np.sort(np.column_stack([corner, corner[after]]), axis=1)
    edge, edges = label_equal_rows(np.column_stack([ends, np.zeros(len(ends), np.int64)]))
    graph = coo_array((np.ones(len(edge), np.int8), (patch, count + edge)), shape=(count + edges,) * 2)
    label = connected_components(graph, directed=False)[1][:count]
    return np.asarray(np.unique(label, return_inverse=True)[1], np.int64)


def _without_hidden(
    held: Patches, surface: Patches, below: Bools, overlap: float, rise: Floats
) -> tuple[Patches, Bools]:
    """Leave out what is hidden by other patches below it, where a column has many.

    Returns
    -------
    held, below
        What stays of both.
    """
    keep, below = np.ones(len(held.owner), np.bool_), below.copy()
    many = np.bincount(surface.owner[below, 0], minlength=len(held.of_column) - 1) > CROWDED
    for column in np.flatnonzero(many).tolist():
        ours, theirs = (slice(*each.of_column[column : column + 2]) for each in (held, surface))
        around = *surface.in_column(column), rise[theirs]
        lift = np.full(ours.stop - ours.start, overlap)
        spacing = float(np.ptp(around[0][:, :2], axis=0).max()) / _SAMPLES
        patch_kernels.find_seen(*held.in_column(column), lift, *around, spacing, keep[ours])
        seen = np.zeros(theirs.stop - theirs.start, np.bool_)
        patch_kernels.find_seen(*around, *around, spacing, seen)
        below[theirs] &= seen
    return held.chosen(keep), below


def _prisms(
    points: Floats, start: Ints, rise: Floats | float, level: float, *, hang: bool = False
) -> Iterator["Manifold"]:
    """Yield solids that together fill the space between patches, raised, and a level below them, or above.

    Each joins the prisms of all patches that do not get in each other's way.

    Parameters
    ----------
    points, start
        As in `Patches`.
    rise
        mm, for each patch or for all.
    hang
        Whether the prisms hang from the level.
    """
    sizes = np.diff(start)
    points = points.copy()
    points[:, 2] += np.repeat(np.broadcast_to(rise, len(sizes)), sizes)
    points = kept(points) * (1.0, 1.0, -1.0 if hang else 1.0)
    colour = np.empty(len(sizes), np.int64)
    patch_kernels.colour_patches(points, start, _LOWEST, colour)
    nowhere = np.zeros((len(sizes), 2), np.int64)
    patches = Patches(points, start, nowhere, np.array([0, len(sizes)]))
    for each in range(int(colour.max(initial=-1)) + 1):
        chosen = patches.chosen(colour == each)
        base = np.full(len(chosen.owner), -level if hang else level)
        corners, triangles = separate_edges(*stand_on(chosen, base, 0.0))
        yield as_manifold(
            *((corners * (1.0, 1.0, -1.0), triangles[:, ::-1]) if hang else (corners, triangles))
        )


def stand_on(patches: Patches, base: Floats, rise: float) -> Arrays:
    """Return the union of the prisms from the patches, raised by `rise`, down to `base`, as one closed mesh.

    No two patches lie above one another. Neighbours share no walls: what both have cancels, because all
    walls are cut at all the heights at which some prism begins.

    Parameters
    ----------
    base
        ``(n,)`` mm, where each prism begins.
    """
    sizes = np.diff(patches.start)
    count = len(patches.points)
    top = kept(patches.points + (0.0, 0.0, rise))
    levels = np.unique(kept(base))
    begins = np.repeat(np.searchsorted(levels, kept(base)), sizes)
    first = np.repeat(patches.start[:-1], sizes)
    here = np.arange(count)
    following = np.where(here + 1 == np.repeat(patches.start[1:], sizes), first, here + 1)
    inner = (here != first) & (following != first)
    fans = top[np.column_stack([first, here, following])[inner]]
    floors = fans[:, ::-1].copy()
    floors[:, :, 2] = levels[begins[inner], None]
    soup = np.concatenate([fans, floors, *_walls(top, top[following], levels, begins)])
    return weld(soup.reshape(-1, 3), np.arange(3 * len(soup)).reshape(-1, 3), lattice=0.0)


def _walls(left: Floats, right: Floats, levels: Floats, begins: Ints) -> Iterator[Floats]:
    """Yield the triangles of walls under edges, seen from outside; cut at the levels that both ends pass.

    Parameters
    ----------
    left, right
        ``(n, 3)`` the upper ends of each wall.
    levels, begins
        Heights in ascending order, and ``(n,)`` at which of them each wall begins.
    """
    forth = (left[:, 0] < right[:, 0]) | ((left[:, 0] == right[:, 0]) & (left[:, 1] < right[:, 1]))
    last = [np.maximum(np.searchsorted(levels, each[:, 2] - _LOWEST) - 1, begins) for each in (left, right)]
    shared = np.minimum(*last)

    def at(ends: Floats, chosen: Bools, level: Ints) -> Floats:
        return np.column_stack([ends[chosen, :2], levels[level[chosen]]])

    for up in range(int((shared - begins).max(initial=0))):
        chosen, low = begins + up < shared, begins + up
        high = np.minimum(low + 1, len(levels) - 1)
        yield from _quads_cut(
            at(left, chosen, low), at(right, chosen, low), at(right, chosen, high), at(left, chosen, high),
            forth[chosen],
        )  # fmt: skip
    level = (last[0] == last[1]) & (shared == last[0])
    yield from _quads_cut(
        at(left, level, shared), at(right, level, shared), right[level], left[level], forth[level]
    )
    for ends, other, mine, is_left in ((left, right, last[0], True), (right, left, last[1], False)):
        taller = mine > shared
        apex = other[taller]
        bottom = at(left, taller, shared), at(right, taller, shared)
        yield np.stack([*bottom, apex], axis=1)
        for up in range(int((mine - shared).max(initial=0))):
            chosen, low = taller & (shared + up < mine), shared + up
            lower, upper = at(ends, chosen, low), at(ends, chosen, np.minimum(low + 1, len(levels) - 1))
            yield _turned(lower, other[chosen], upper, turn=not is_left)
        yield _turned(at(ends, taller, mine), apex, ends[taller], turn=not is_left)


def _turned(a: Floats, b: Floats, c: Floats, *, turn: bool) -> Floats:
    return np.stack([a, c, b] if turn else [a, b, c], axis=1)


def _quads_cut(a: Floats, b: Floats, c: Floats, d: Floats, forth: Bools) -> Iterator[Floats]:
    """Yield the halves of quadrangles, cut from a to c where `forth`, else from b to d."""
    across = forth[:, None]
    yield np.stack([a, b, np.where(across, c, d)], axis=1)
    yield np.stack([np.where(across, a, b), c, d], axis=1)
