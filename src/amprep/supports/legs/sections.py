"""Divide routed supports into sections: pieces of one plane of the grid whose columns touch."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports.edges import SupportEdges, square_keys

DIRECTION_COUNT = 12
"""Number of horizontal directions in which widths are measured."""

PLANES_TO_TOUCH = 4
"""Number of consecutive planes that two columns must be neighbours on before their cells touch somewhere.

Cells join their neighbours in every third layer (`x-wall`, `strut`), so that powder escapes between them.
"""

_NEIGHBOURS = ((0, 0, 1), (0, 1, 0))


class Sections(NamedTuple):
    """Pieces of the planes of the grid, and the links that the edges form between them.

    Attributes
    ----------
    square
        ``(n, 3)`` int32 plane, y, x: the squares in use, sorted.
    part
        ``(n,)`` int32, part of each square.
    section
        ``(n,)`` int64, section of each square; some numbers are not used.
    width
        ``(m,)`` mm, least width of the convex hull of each section.
    held
        ``(m,)`` bool: on the plate, on a part, or below a connector.
    link
        ``(k, 2)`` int64: the upper and the lower section of each link, each pair once.
    length
        ``(k,)`` mm, length of each link.
    """

    square: Ints
    part: Ints
    section: Int64s
    width: Floats
    held: Bools
    link: Int64s
    length: Floats


def directions() -> Floats:
    """Return the horizontal directions ``(DIRECTION_COUNT, 2)``, unit vectors x, y, in which widths are measured."""
    angle = np.arange(DIRECTION_COUNT) * np.pi / DIRECTION_COUNT
    return np.column_stack([np.cos(angle), np.sin(angle)])


def find_sections(grid: Grid, edges: SupportEdges, held: Ints, cell: Floats) -> Sections:
    """Return the sections of all supports.

    Parameters
    ----------
    grid
        The support grid.
    edges
        The edges of all supports, each with its part.
    held
        ``(h, 3)`` squares that a part holds, or that stand on one; those on the plate are held in any case.
    cell
        ``(DIRECTION_COUNT,)`` mm, extents of one cell, see `amprep.supports.legs.cell.measure_cell`.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = np.concatenate([edges.upper, edges.lower])
    keys, first, number = np.unique(square_keys(ends), return_index=True, return_inverse=True)
    square, part = ends[first], np.concatenate([edges.part, edges.part])[first]
    a, b = _touching(square, part, keys)
    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(len(keys), len(keys)))
    count, pieces = connected_components(graph, directed=False) if len(keys) else (0, np.empty(0, np.int32))
    is_held = np.zeros(count, np.bool_)
    is_held[pieces[np.isin(keys, square_keys(held)) | (square[:, 0] == 0)]] = True
    pairs = number.reshape(2, -1)
    section = _without_short_loops(pieces.astype(np.int64), pairs, is_held)
    upper, lower = section[pairs]
    link, pair = np.unique(np.column_stack([upper, lower]), axis=0, return_inverse=True)
    length = np.full(len(link), np.inf)
    across = np.where(edges.direction > 0, grid.pitch, 0.0)
    np.minimum.at(length, pair.ravel(), np.hypot(grid.step, across))
    return Sections(
        square, part, section, _widths(square, section, count, grid.pitch, cell), is_held, link, length
    )


def _without_short_loops(section: Int64s, pairs: Int64s, held: Bools) -> Int64s:
    """Return sections in which columns that part for at most two planes, as in a bend, are one.

    Parameters
    ----------
    section
        ``(n,)`` section of each square.
    pairs
        ``(2, e)`` upper and lower square of each edge.
    held
        ``(m,)`` whether a section is held.
    """
    upper, lower = np.unique(section[pairs], axis=1)
    count = len(held)
    above, below = np.bincount(lower, minlength=count), np.bincount(upper, minlength=count)
    inner = np.append((above == 1) & (below == 1) & ~held, False)
    up, down = np.full((2, count + 1), -1)
    up[lower], down[upper] = upper, lower
    same = np.arange(count)
    for planes in (1, 2):
        low = np.flatnonzero(inner & (inner[up] | (planes == 1)))
        high = low if planes == 1 else up[low]
        ends = np.column_stack([down[low], up[high]])
        _, first, loop = np.unique(ends, axis=0, return_index=True, return_inverse=True)
        same[low], same[high] = low[first[loop.ravel()]], high[first[loop.ravel()]]
    return np.asarray(same[section])


def _touching(square: Ints, part: Ints, keys: Int64s) -> tuple[Int64s, Int64s]:
    """Return the pairs of neighbouring squares of a part whose columns are neighbours for long enough to touch."""
    lower, upper = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for step in _NEIGHBOURS:
        wanted = square_keys(square + np.array(step, np.int32))
        at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        here = np.flatnonzero((keys[at] == wanted) & (part[at] == part))
        here = here[np.lexsort(square[here].T)]  # column by column, upwards in each
        begins = np.ones(len(here), np.bool_)
        begins[1:] = (np.diff(square[here], axis=0) != (1, 0, 0)).any(axis=1)
        run = np.cumsum(begins) - 1
        here = here[np.bincount(run)[run] >= PLANES_TO_TOUCH]
        lower.append(here)
        upper.append(at[here])
    return np.concatenate(lower), np.concatenate(upper)


def _widths(square: Ints, section: Ints, count: int, pitch: float, cell: Floats) -> Floats:
    """Return the least width of each section over all directions, mm."""
    least = np.full(count, np.inf)
    for direction, extent in zip(directions(), cell, strict=True):
        along = square[:, :0:-1] @ direction
        low, high = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(low, section, along)
        np.maximum.at(high, section, along)
        least = np.minimum(least, (high - low) * pitch + extent)
    return least
