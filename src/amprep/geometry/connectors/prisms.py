"""Prisms below and between patches."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.connectors.columns import LOWEST, Patches
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.welding import round_as_stored, weld
from amprep.kernels.meshes import patches as patch_kernels

if TYPE_CHECKING:
    from manifold3d import Manifold


def prisms_between(
    points: Floats, start: Int64s, rise: Floats | float, level: float, *, hang: bool = False
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
    points = round_as_stored(points) * (1.0, 1.0, -1.0 if hang else 1.0)
    colour = np.empty(len(sizes), np.int64)
    patch_kernels.colour_patches(points, start, LOWEST, colour)
    nowhere = np.zeros((len(sizes), 2), np.int64)
    patches = Patches(points, start, nowhere, np.array([0, len(sizes)]))
    for each in range(int(colour.max(initial=-1)) + 1):
        chosen = patches.chosen(colour == each)
        base = np.full(len(chosen.owner), -level if hang else level)
        corners, triangles = split_nonmanifold_edges(*prisms_below(chosen, base, 0.0))
        yield as_manifold(
            *((corners * (1.0, 1.0, -1.0), triangles[:, ::-1]) if hang else (corners, triangles))
        )


def prisms_below(patches: Patches, base: Floats, rise: float) -> MeshArrays:
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
    top = round_as_stored(patches.points + (0.0, 0.0, rise))
    levels = np.unique(round_as_stored(base))
    begins = np.repeat(np.searchsorted(levels, round_as_stored(base)), sizes)
    first = np.repeat(patches.start[:-1], sizes)
    here = np.arange(count)
    following = np.where(here + 1 == np.repeat(patches.start[1:], sizes), first, here + 1)
    inner = (here != first) & (following != first)
    fans = top[np.column_stack([first, here, following])[inner]]
    floors = fans[:, ::-1].copy()
    floors[:, :, 2] = levels[begins[inner], None]
    soup = np.concatenate([fans, floors, *_walls(top, top[following], levels, begins)])
    return weld(soup.reshape(-1, 3), np.arange(3 * len(soup)).reshape(-1, 3), lattice=0.0)


def _walls(left: Floats, right: Floats, levels: Floats, begins: Int64s) -> Iterator[Floats]:
    """Yield the triangles of walls under edges, seen from outside; cut at the levels that both ends pass.

    Parameters
    ----------
    left, right
        ``(n, 3)`` the upper ends of each wall.
    levels, begins
        Heights in ascending order, and ``(n,)`` at which of them each wall begins.
    """
    forth = (left[:, 0] < right[:, 0]) | ((left[:, 0] == right[:, 0]) & (left[:, 1] < right[:, 1]))
    last = [np.maximum(np.searchsorted(levels, each[:, 2] - LOWEST) - 1, begins) for each in (left, right)]
    shared = np.minimum(*last)

    def at(ends: Floats, chosen: Bools, level: Int64s) -> Floats:
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
