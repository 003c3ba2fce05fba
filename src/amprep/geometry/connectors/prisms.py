"""Closed meshes of the prisms between patches and a level below or above them."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.welding import round_as_stored, weld
from amprep.kernels.meshes.patches import Patches, colour_patches

if TYPE_CHECKING:
    from manifold3d import Manifold

_LEAST_CUT = 1e-4
"""Least distance (mm) of a cut through a wall from the upper end of the wall."""

# Strategy. The union of prisms below patches that do not overlap in plan needs no Boolean. The mesh of one prism is its
# patch, its floor, and one wall per side. Neighbouring patches share a side, and their walls there face each other; if
# both consist of the same triangles, `weld` cancels them. Two rules make the triangles the same:
# - Prisms may begin at different heights. So every wall is cut at all heights at which any prism begins, between its
#   own lower and upper ends.
# - The diagonal of each quadrangle depends only on the positions of its ends (`forward`), not on its direction.
# A wall of which one end passes more of these heights than the other ends in a fan of triangles around the lower end.
# The time is linear in the number of triangles.


def solids_between(
    points: Floats, start: Int64s, rise: Floats | float, level: float, *, from_above: bool = False
) -> Iterator["Manifold"]:
    """Yield solids whose union is the space between patches and a level below them, or above them.

    Each solid is the union of the prisms of patches that do not conflict (`colour_patches`).

    Parameters
    ----------
    points, start
        Corners ``(p, 3)`` mm, and index of the first corner of each patch ``(n + 1,)``, as in `Patches`.
    rise
        Height (mm) by which patches are raised, ``(n,)`` or one for all.
    level
        Height (mm) of the other end of the prisms.
    from_above
        Whether the level is above the patches.
    """
    sizes = np.diff(start)
    points = points.copy()
    points[:, 2] += np.repeat(np.broadcast_to(rise, len(sizes)), sizes)
    points = round_as_stored(points) * (1.0, 1.0, -1.0 if from_above else 1.0)
    colour = np.empty(len(sizes), np.int64)
    colour_patches(points, start, _LEAST_CUT, colour)
    patches = Patches(points, start, np.zeros((len(sizes), 2), np.int64), np.array([0, len(sizes)]))
    for each in range(int(colour.max(initial=-1)) + 1):
        chosen = patches.chosen(colour == each)
        base = np.full(len(chosen.owner), -level if from_above else level)
        corners, triangles = split_nonmanifold_edges(*prisms_below(chosen, base, 0.0))
        if from_above:
            corners, triangles = corners * (1.0, 1.0, -1.0), triangles[:, ::-1]
        yield as_manifold(corners, triangles)


def prisms_below(patches: Patches, base: Floats, rise: float) -> MeshArrays:
    """Return the union of the prisms from raised patches down to their bases as one closed mesh.

    Parameters
    ----------
    patches
        Patches that do not overlap in plan.
    base
        ``(n,)`` mm, height at which each prism begins.
    rise
        Height (mm) by which patches are raised.
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
    tops = top[np.column_stack([first, here, following])[inner]]
    floors = tops[:, ::-1].copy()
    floors[:, :, 2] = levels[begins[inner], None]
    soup = np.concatenate([tops, floors, *_walls(top, top[following], levels, begins)])
    return weld(soup.reshape(-1, 3), np.arange(3 * len(soup)).reshape(-1, 3), lattice=0.0)


def _walls(left: Floats, right: Floats, levels: Floats, begins: Int64s) -> Iterator[Floats]:
    """Yield the triangles of the walls below edges, cut at the levels between their lower and upper ends.

    Parameters
    ----------
    left, right
        ``(n, 3)`` upper ends of each wall, seen from outside.
    levels, begins
        Heights in ascending order, mm, and ``(n,)`` index of the one at which each wall begins.
    """
    forward = (left[:, 0] < right[:, 0]) | ((left[:, 0] == right[:, 0]) & (left[:, 1] < right[:, 1]))
    # index of the last level that the left and the right end pass, and of the last that both pass
    last = [
        np.maximum(np.searchsorted(levels, each[:, 2] - _LEAST_CUT) - 1, begins) for each in (left, right)
    ]
    shared = np.minimum(*last)

    def at(ends: Floats, chosen: Bools, level: Int64s) -> Floats:
        return np.column_stack([ends[chosen, :2], levels[level[chosen]]])

    for up in range(int((shared - begins).max(initial=0))):
        chosen, low = begins + up < shared, begins + up
        high = np.minimum(low + 1, len(levels) - 1)
        yield from _split_quads(
            at(left, chosen, low), at(right, chosen, low), at(right, chosen, high), at(left, chosen, high),
            forward[chosen],
        )  # fmt: skip
    even = (last[0] == last[1]) & (shared == last[0])
    yield from _split_quads(
        at(left, even, shared), at(right, even, shared), right[even], left[even], forward[even]
    )
    for ends, other, mine, is_left in ((left, right, last[0], True), (right, left, last[1], False)):
        taller = mine > shared
        apex = other[taller]
        bottom = at(left, taller, shared), at(right, taller, shared)
        yield np.stack([*bottom, apex], axis=1)
        for up in range(int((mine - shared).max(initial=0))):
            chosen, low = taller & (shared + up < mine), shared + up
            lower, upper = at(ends, chosen, low), at(ends, chosen, np.minimum(low + 1, len(levels) - 1))
            yield _triangles(lower, other[chosen], upper, flip=not is_left)
        yield _triangles(at(ends, taller, mine), apex, ends[taller], flip=not is_left)


def _triangles(a: Floats, b: Floats, c: Floats, *, flip: bool) -> Floats:
    return np.stack([a, c, b] if flip else [a, b, c], axis=1)


def _split_quads(a: Floats, b: Floats, c: Floats, d: Floats, forward: Bools) -> Iterator[Floats]:
    """Yield the halves of quadrangles, split from a to c where `forward`, otherwise from b to d."""
    across = forward[:, None]
    yield np.stack([a, b, np.where(across, c, d)], axis=1)
    yield np.stack([np.where(across, a, b), c, d], axis=1)
