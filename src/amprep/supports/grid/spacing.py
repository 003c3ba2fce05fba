"""Choose the red squares that are connected, so that contacts are no farther apart than the contact spacing.

Strategy. A grid finer than the contact spacing has more red squares than an overhang needs. Connected are
1. the rim: squares without a neighbour on one of their eight sides, and squares that the overhang covers by less
   than half, with the squares beside them; along the rim contacts are at most half the spacing apart. A strip of an
   overhang that covers less than a quarter of a square is left to the contact beside it;
2. the square below the lowest point of each region;
3. of the others those of a square lattice as wide as the spacing; as wide as half the spacing in the first layers of
   a large region that starts in the air, where the part lifts off and pulls at its supports most.
Every interior square then has connected squares on all four sides within the spacing: a lattice point, or the rim
before it. Squares without a path to the plate stay in the list, so that they are named; the squares beside them are
rim.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.meshes.sampling import sample_overhangs
from amprep.geometry.overhangs.regions import NOT_FACES
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports.edges import square_keys
from amprep.model.supports.rules import SectionRules
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.grid.red_squares import RedSquares, SupportGrid

LARGE_AREA = 100.0
"""Area (mm2) above which a region that starts in the air has closer contacts in its first layers."""

FIRST_LAYERS = 10
"""Number of its first layers."""

_STRIP = 0.3
"""Fraction of a square below which an overhang covers only a strip of it; 4 of 16 samples are below, 5 above."""

_SAMPLES = 4
"""Samples of an overhang along each side of a square."""

_AROUND = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if (y, x) != (0, 0)]


class SpacedSquares(NamedTuple):
    """Red squares to connect.

    Attributes
    ----------
    chosen
        ``(m,)`` the squares to connect.
    close
        ``(m,)`` squares where contacts are at most half the spacing apart.
    """

    chosen: Bools
    close: Bools


def space_contacts(
    laid: SupportGrid,
    overhangs: Sequence[PartOverhangs],
    reachable: Bools,
    *,
    spacing: float,
    rules: SectionRules,
    layer: float,
) -> SpacedSquares:
    """Choose the red squares to connect.

    Parameters
    ----------
    laid
        The grid with all red squares.
    overhangs
        The overhangs of each part that are to be supported.
    reachable
        ``(m,)`` red squares with a path to the plate.
    spacing
        Largest distance between neighbouring contacts, mm.
    rules
        Least wall: narrower contacts are dropped later, so that the squares beside them must have contacts, too.
    layer
        Height of a printed layer, mm.
    """
    count = len(laid.red.part)
    spaced = SpacedSquares(~reachable, np.zeros(count, np.bool_))
    for part, own in enumerate(overhangs):
        mine = np.flatnonzero(reachable & (laid.red.part == part))
        if len(mine):
            region = laid.red.region[mine]
            full = max(0.5, min(1.2 * rules.least_wall_mm / laid.grid.pitch, 1.0))
            chosen, close = _of_part(laid.red.square[mine], region, own, laid.grid, (spacing, full, layer))
            spaced.chosen[mine], spaced.close[mine] = chosen, close
    return spaced


def _of_part(
    square: Ints, region: Ints, own: PartOverhangs, grid: Grid, rules: tuple[float, float, float]
) -> tuple[Bools, Bools]:
    """Return chosen and close squares of a part for a spacing, the fraction of full squares, and a layer height."""
    spacing, full, layer = rules
    cover = _cover_of(square, own, grid)
    rim = _has_gap(square, np.ones(len(square), np.bool_))
    is_full = cover.fraction >= full
    rim |= ~is_full | _has_gap(square, is_full)
    is_edge = np.array([each.kind in NOT_FACES for each in own.overhangs.regions], np.bool_)[region]
    rim |= is_edge
    first = cover.lowest <= _first_layers(own, layer)[region]
    wide, narrow = steps_within(spacing, grid.pitch), steps_within(spacing / 2, grid.pitch)
    chosen = _is_on_lattice(square, wide) | (first & _is_on_lattice(square, narrow))
    chosen |= _one_in_each_block(square, rim, (steps_within(spacing / 2 / np.sqrt(2), grid.pitch) + 1) // 2)
    is_strip = ~is_edge & (cover.fraction < _STRIP) & _is_beside(square, is_full) & (grid.pitch <= spacing)
    chosen &= ~is_strip
    chosen[_at_lowest_points(square, region, own, grid)] = True
    return chosen, rim | first


def steps_within(distance: float, pitch: float) -> int:
    """Return the largest number of squares, at least 1, whose sides add up to at most `distance` mm."""
    return max(1, int(distance / pitch + 1e-9))


def are_beside(red: RedSquares, numbers: Ints, steps: int) -> Bools:
    """Tell which red squares are at most `steps` columns and planes from one of the numbered ones of their part."""
    from scipy.spatial import cKDTree

    beside = np.zeros(len(red.part), np.bool_)
    for part in np.unique(red.part[numbers]):
        mine = np.flatnonzero(red.part == part)
        tree = cKDTree(red.square[numbers[red.part[numbers] == part]])
        distance, _ = tree.query(red.square[mine], p=np.inf, distance_upper_bound=steps + 0.5)
        beside[mine] = np.isfinite(distance)
    return beside


class _Cover(NamedTuple):
    """What the overhangs cover of the column of each square: fraction in plan, and lowest height (mm)."""

    fraction: Floats
    lowest: Floats


def _cover_of(square: Ints, own: PartOverhangs, grid: Grid) -> _Cover:
    samples = sample_overhangs(own.mesh.vertices, own.mesh.triangles, own.overhangs, grid.pitch / _SAMPLES)
    points = samples.points[samples.inner]
    column = np.floor((points - grid.origin) / grid.size).astype(np.int64)[:, 1::-1]
    key, number = np.unique(_column_keys(square[:, 1:]), return_inverse=True)
    place = np.minimum(np.searchsorted(key, _column_keys(column)), len(key) - 1)
    held = key[place] == _column_keys(column)
    place = place[held]
    fraction = np.bincount(place, minlength=len(key)) / _SAMPLES**2
    lowest = np.full(len(key), np.inf)
    np.minimum.at(lowest, place, points[held, 2])
    return _Cover(fraction[number], lowest[number])


def _column_keys(column: Ints | Int64s) -> Int64s:
    y, x = column.T.astype(np.int64)
    return np.asarray((y << 20) + x)


def _has_gap(square: Ints, present: Bools) -> Bools:
    """Tell which squares have no present neighbour on one of their eight sides."""
    return np.asarray(~np.all(_neighbours(square, present), axis=0))


def _is_beside(square: Ints, present: Bools) -> Bools:
    """Tell which squares have a present neighbour on one of their eight sides."""
    return np.asarray(np.any(_neighbours(square, present), axis=0))


def _neighbours(square: Ints, present: Bools) -> Bools:
    """Tell on which of eight sides squares have a present neighbour, at most one plane higher or lower, ``(8, m)``."""
    keys = np.append(np.unique(square_keys(square[present])), np.iinfo(np.int64).max)

    def is_present(shift: tuple[int, int, int]) -> Bools:
        wanted = square_keys(square + shift)
        return np.asarray(keys[np.searchsorted(keys, wanted)] == wanted)

    return np.array([np.any([is_present((plane, y, x)) for plane in (-1, 0, 1)], axis=0) for y, x in _AROUND])


def _first_layers(own: PartOverhangs, layer: float) -> Floats:
    """Return for each region the height (mm) of its first layers if it is large and starts in the air, else -inf."""
    return np.array(
        [
            each.lowest_mm + FIRST_LAYERS * layer
            if each.starts_in_air and each.kind not in NOT_FACES and each.measure > LARGE_AREA
            else -np.inf
            for each in own.overhangs.regions
        ]
    )


def _is_on_lattice(square: Ints, step: int) -> Bools:
    return np.asarray((square[:, 1] % step == 0) & (square[:, 2] % step == 0))


def _one_in_each_block(square: Ints, wanted: Bools, side: int) -> Bools:
    """Choose the first wanted square in each block of `side` x `side` columns and one plane."""
    chosen = np.zeros(len(square), np.bool_)
    found = np.flatnonzero(wanted)
    block = square[found] // (1, side, side)
    chosen[found[np.unique(block, axis=0, return_index=True)[1]]] = True
    return chosen


def _at_lowest_points(square: Ints, region: Ints, own: PartOverhangs, grid: Grid) -> Int64s:
    """Return for each region the square that is the nearest in plan to its lowest point."""
    found, vertices = own.overhangs, own.mesh.vertices
    held = [found.face_region, found.edge_region, found.tip_region]
    points = [own.mesh.triangles[found.faces], found.edges, found.tips[:, None]]
    nearest = []
    for number in np.unique(region):
        corners = np.concatenate(
            [each[own_region == number].ravel() for each, own_region in zip(points, held, strict=True)]
        )
        mine = np.flatnonzero(region == number)
        if len(corners):
            low = vertices[corners[vertices[corners, 2].argmin()]]
            middle = grid.origin[:2] + (square[mine, :0:-1] + 0.5) * grid.pitch
            nearest.append(mine[((middle - low[:2]) ** 2).sum(axis=1).argmin()])
    return np.array(nearest, np.int64)
