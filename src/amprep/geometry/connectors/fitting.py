"""Move the places of teeth and points so that whole tips are on the contact, or leave them out."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import merge_equal_vertices
from amprep.geometry.supports.footprints import box, union_of

if TYPE_CHECKING:
    from manifold3d import CrossSection

WHOLE = 1.0 - 1e-6
"""Fraction of a cell that counts as all of it."""

ROOT = 0.05
"""Margin on each side of the root of a tip, as a fraction of the cell."""

_SEAM = 1e-3
"""Width (mm) of seams between neighbouring triangles that are closed."""

_MARGIN = 0.01
"""Distance (mm) between a tip and the border of the contact."""

_SPREADS = (1.0, 0.5, 0.25)
"""Fractions of the widening towards the root of a tip that are tried."""

_SPECK = 1e-5
"""Area (mm2) of a cell outside the contact that rounding leaves."""

# Strategy. A tip that the border of the contact cuts leaves slivers, so tips are only where they are whole.
# 1. Most cells are covered entirely by one surface, and their tips are whole. Only the others are looked at. Surfaces
#    with a wall between them are two contacts: a tip below both would end in a sliver beside the wall.
# 2. The centres of discs that fit into a contact are the contact shrunk by their radius. A tip moves to the nearest
#    of them in its cell; if there is none, the tip becomes as narrow as the least section, and at last may be partly in
#    the next cell. Where none of that helps, the cell has no tip, unless it would be the only one of its column.
# 3. Below the part a tip widens towards its root, as far as the contact reaches: then its column is whole, too.
# Each step is one operation on the union of all cells; what it leaves belongs to the cell in which it is.


class TipPlaces(NamedTuple):
    """Where tips are, and how wide.

    Attributes
    ----------
    spot
        ``(s, 2)`` mm, their centres in plan.
    width
        ``(s,)`` mm, their widths at the part.
    spread
        ``(s,)`` fraction of the widening towards the whole cell that their roots have.
    inside
        ``(s,)`` whether the tip is moved into its cell; otherwise it is exactly at its spot.
    kept
        ``(s,)`` whether there is a tip.
    """

    spot: Floats
    width: Floats
    spread: Floats
    inside: Bools
    kept: Bools

    def those_kept(self) -> "TipPlaces":
        """Return the places where there is a tip."""
        own = self.kept
        return TipPlaces(self.spot[own], self.width[own], self.spread[own], self.inside[own], self.kept[own])


class _TipCells(NamedTuple):
    """Cells of a fine grid: corners ``(s, 2)`` mm, and column ``(s,)``."""

    lo: Floats
    hi: Floats
    column: Int64s

    def shrunk(self, rows: Int64s, by: float) -> tuple[Floats, Floats]:
        """Return the corners of some cells moved inwards."""
        return self.lo[rows] + by, self.hi[rows] - by


def unfitted(spot: Floats, width: float) -> TipPlaces:
    """Return tips of one width at their spots."""
    count = len(spot)
    every = np.ones(count, np.bool_)
    return TipPlaces(spot, np.full(count, width), np.ones(count), every, every)


def surfaces_of(contact: Floats) -> Int64s:
    """Return the connected surface ``(t,)`` of each triangle that faces down; -1 for the others.

    Walls between two surfaces are steep, and connect none.
    """
    label = np.full(len(contact), -1)
    down = np.flatnonzero(_faces_down(contact))
    if len(down):
        corner = np.arange(3 * len(down)).reshape(-1, 3)
        points, triangles = merge_equal_vertices(contact[down].reshape(-1, 3), corner)
        label[down] = label_shells(triangles, len(points))[1]
    return label


def fit_tips(
    places: TipPlaces,
    whole: Bools,
    corners: tuple[Floats, Floats],
    column: Int64s,
    contact: Floats,
    surface: Int64s,
    narrow: float,
) -> TipPlaces:
    """Return places at which tips are whole.

    Parameters
    ----------
    places
        Tips of one width at the spots where they are wanted.
    whole
        ``(s,)`` whether one surface of the contact covers the cell entirely.
    corners
        Least and greatest corners ``(s, 2)`` mm of the cells.
    column
        ``(s,)`` column of each cell.
    contact
        ``(t, 3, 3)`` mm, triangles of the part inside the connectors; only faces that point down are used.
    surface
        ``(t,)`` result of `surfaces_of`.
    narrow
        Width (mm) of the narrowest tips.
    """
    spot, width, spread = places.spot.copy(), places.width.copy(), places.spread.copy()
    inside, kept = places.inside.copy(), places.kept.copy()
    rows = np.flatnonzero(~whole)
    if not len(rows):
        return places
    cells, outlines = _TipCells(*corners, column), _outlines(contact, surface)
    wide = float(width[0])
    narrow = min(narrow, wide)
    kept[rows] = False
    for size, margin, within in (
        (wide, wide / 2.0, True),
        (narrow, narrow / 2.0, True),
        (narrow, _MARGIN, False),
    ):
        left = rows[~kept[rows]]
        found, nearest = _nearest(_centres(outlines, size), spot[left], *cells.shrunk(left, margin))
        own = left[found]
        spot[own], width[own], inside[own], kept[own] = nearest[found], size, within, True
    _reach_into_columns(spot, width, inside, kept, cells, outlines, narrow)
    spread[rows] = 0.0
    for fraction_of_root in _SPREADS:
        left = rows[kept[rows] & inside[rows] & (spread[rows] == 0.0)]
        half = width[left, None] / 2.0
        rim = ROOT * (cells.hi - cells.lo)[left]
        lo, hi = root_of(
            (spot[left] - half, spot[left] + half),
            cells.lo[left] + rim,
            cells.hi[left] - rim,
            fraction_of_root,
        )
        middle = (cells.lo[left] + cells.hi[left]) / 2.0
        spread[left[_are_covered(outlines, lo, hi, middle)]] = fraction_of_root
    return TipPlaces(spot, width, spread, inside, kept)


def root_of(
    top: tuple[Floats, Floats], lo: Floats, hi: Floats, spread: Floats | float
) -> tuple[Floats, Floats]:
    """Return the roots of tips: their tops, widened by a fraction towards rectangles, of which all are corners."""
    return top[0] + spread * (np.minimum(lo, top[0]) - top[0]), top[1] + spread * (
        np.maximum(hi, top[1]) - top[1]
    )


def _faces_down(contact: Floats) -> Bools:
    one, other = contact[:, 1, :2] - contact[:, 0, :2], contact[:, 2, :2] - contact[:, 0, :2]
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] < 0.0)


def _outlines(contact: Floats, surface: Int64s) -> "list[CrossSection]":
    """Return the surfaces of the contact in plan, without seams."""
    from manifold3d import CrossSection, FillRule, JoinType

    order = np.argsort(surface, kind="stable")
    order = order[surface[order] >= 0]
    found = []
    for own in np.split(order, np.flatnonzero(np.diff(surface[order])) + 1):
        region = CrossSection(list(np.ascontiguousarray(contact[own, ::-1, :2])), FillRule.NonZero)
        found.append(region.offset(_SEAM, JoinType.Miter).offset(-_SEAM, JoinType.Miter))
    return found


def _centres(outlines: "Sequence[CrossSection]", size: float) -> "CrossSection":
    """Return the centres of the discs of a diameter (mm) that fit into one of the outlines."""
    return union_of([outline.offset(-size / 2.0 - _MARGIN) for outline in outlines])


def _nearest(region: "CrossSection", spot: Floats, lo: Floats, hi: Floats) -> tuple[Bools, Floats]:
    """Return which rectangles ``(k,)``, all apart, meet a region, and the points there nearest to spots ``(k, 2)``."""
    found, nearest = np.zeros(len(spot), np.bool_), spot.copy()
    start, end, owner = _sides(region ^ _boxes(lo, hi), (lo + hi) / 2.0)
    if not len(owner):
        return found, nearest
    found[owner] = True
    own = spot[owner]
    along, offset = end - start, own - start
    step = np.clip((along * offset).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-18), 0.0, 1.0)
    near = start + step[:, None] * along
    crossed = (start[:, 1] <= own[:, 1]) != (end[:, 1] <= own[:, 1])
    right = (along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0]) * np.sign(along[:, 1]) > 0.0
    outside = np.bincount(owner, crossed & right, len(spot)) % 2 == 0
    order = np.lexsort((((near - own) ** 2).sum(axis=1), owner))
    rows, first = np.unique(owner[order], return_index=True)
    moved = outside[rows]
    nearest[rows[moved]] = near[order[first[moved]]]
    return found, nearest


def _are_covered(outlines: "Sequence[CrossSection]", lo: Floats, hi: Floats, middle: Floats) -> Bools:
    """Tell which rectangles ``(k,)``, each in the cell around a middle ``(k, 2)`` mm, one of the outlines covers."""
    found = np.zeros(len(lo), np.bool_)
    for outline in outlines:
        left = np.flatnonzero(~found)
        bounds = np.asarray(outline.bounds())
        left = left[((lo[left] >= bounds[:2] - _SEAM) & (hi[left] <= bounds[2:] + _SEAM)).all(axis=1)]
        covered = np.ones(len(left), np.bool_)
        for piece in (_boxes(lo[left], hi[left]) - outline).decompose():
            if piece.area() > _SPECK:
                covered[_sides(piece, middle[left])[2]] = False
        found[left] = covered
    return found


def _boxes(lo: Floats, hi: Floats) -> "CrossSection":
    return union_of([box(*each) for each in zip(lo, hi, strict=True)])


def _sides(region: "CrossSection", middle: Floats) -> tuple[Floats, Floats, Int64s]:
    """Return the starts and ends ``(n, 2)`` mm of the sides of a region, and the cell of each (nearest middle)."""
    from scipy.spatial import cKDTree

    polygons = [np.asarray(each) for each in region.to_polygons()]
    if not polygons:
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.int64)
    places = np.array([(each.min(axis=0) + each.max(axis=0)) / 2.0 for each in polygons])
    owner = np.asarray(cKDTree(middle).query(places, p=np.inf)[1], np.int64)
    start = np.concatenate(polygons)
    end = np.concatenate([np.roll(each, -1, axis=0) for each in polygons])
    return start, end, np.repeat(owner, [len(each) for each in polygons])


def _reach_into_columns(
    spot: Floats,
    width: Floats,
    inside: Bools,
    kept: Bools,
    cells: _TipCells,
    outlines: "Sequence[CrossSection]",
    narrow: float,
) -> None:
    """Place one tip for each column without any: where it reaches into the column, or as it was wanted."""
    lost = np.setdiff1d(cells.column, cells.column[kept])
    if not len(lost):
        return
    centres, reach = _centres(outlines, narrow), 0.4 * narrow
    for column in lost.tolist():
        rows = np.flatnonzero(cells.column == column)
        lo, hi = cells.lo[rows].min(axis=0) - reach, cells.hi[rows].max(axis=0) + reach
        found, nearest = _nearest(centres, (lo + hi)[None] / 2.0, lo[None], hi[None])
        row = rows[np.abs(spot[rows] - nearest[0]).max(axis=1).argmin()]
        kept[row] = True
        if found[0]:
            spot[row], width[row], inside[row] = nearest[0], narrow, False
