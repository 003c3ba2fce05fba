"""Find what is too thin in a horizontal section of a solid, from the narrow ends of its outline."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.slicing.contours import PlaneContours
from amprep.geometry.supports.footprints import box, union_of
from amprep.geometry.supports.waists import INWARDS, keep_narrow

if TYPE_CHECKING:
    from manifold3d import CrossSection

_TURN = np.radians(145.0)
"""Angle by which an outline turns at a narrow end; sharper corners than the rest to 180 degrees are narrow ends."""

_WEDGE = np.radians(190.0)
"""Angle by which an outline turns at the wider end of a wedge."""

_WEDGE_SPAN = 1.4
"""Length (in widths) of the end of a wedge."""

_STUBBY, _SHORT = 0.6, 6.0
"""Twice the area over the perimeter, and the perimeter (both in widths), up to which a whole piece may be too thin.

Half a round pin whose radius is the width has 0.61 and 5.1, and its ends are longer than the width."""

_NARROW = 0.7
"""Twice the area over the perimeter (in widths) up to which a piece of any size may be too thin everywhere."""

_VERTICES = 4
"""Largest number of vertices of a narrow end."""

_SMOOTH = 0.003
"""Distance (mm) by which outlines are simplified."""

_CORNER = 1.3
"""Distance (in widths) by which corners may reach beyond the discs that fit into a region."""

_AROUND = 8.0
"""Half of the side (in widths) of the squares around narrow ends in which a region is looked at."""

_MOST_SQUARES = 16
"""Largest number of squares; offsets of the whole section take less time than those in more of them."""

_BORDER = 1.5
"""Distance (in widths) from the border of these squares in which nothing is judged."""

_ROUNDS = 8
"""Largest number of rounds; each shortens long fins by several widths."""

_SEGMENTS = 16
"""Sides of the polygons that stand for circles."""

_SPECK = 1e-3
"""Area (mm2) that offsets of polygons leave by rounding."""

_POINTS = 128
"""Points that are compared with all contours at once."""

# Strategy. Offsets of whole sections take most of the time of a test for thin places, so they are taken only there
# where the outline tells that something may be thin.
# 1. A narrow end (of a fin, or of a thin piece) is a short stretch of the outline that turns by nearly 180 degrees. A
#    waist between two wide places has a corner that turns inwards, near to which another side of the outline is.
#    What discs of the width near it cover is no such place.
# 2. In a square around each of them, the rest is what discs of the least width, grown by the reach of corners, do
#    not cover. Near the border of the square, which cuts the region, nothing is judged. Only the outlines whose boxes
#    meet the square are cut to it: no other outline encloses a point of it.
# 3. Where the rest is cut away, the next narrow end of a long fin appears; so steps 1 and 2 are repeated there.


class Contours(NamedTuple):
    """The contours of a region.

    Attributes
    ----------
    contours
        Points ``(n, 2)`` mm of each, the region to their left.
    low, high
        ``(k, 2)`` mm, corners of their boxes.
    """

    contours: list[Floats]
    low: Floats
    high: Floats

    def whole(self) -> "CrossSection":
        """Return the region."""
        from manifold3d import CrossSection, FillRule

        return CrossSection(self.contours, FillRule.Positive)

    def inside(self, low: Floats, high: Floats) -> "CrossSection":
        """Return the region inside the union of rectangles with the corners ``(n, 2)`` mm."""
        from manifold3d import CrossSection, FillRule

        meets = np.all((self.low[:, None] < high) & (self.high[:, None] > low), axis=2)
        chosen = [self.contours[each] for each in np.flatnonzero(np.any(meets, axis=1)).tolist()]
        if not chosen:
            return CrossSection()
        boxes = union_of([box(*each) for each in zip(low, high, strict=True)])
        return CrossSection(chosen, FillRule.Positive) ^ boxes

    def cover(self, points: Floats) -> Bools:
        """Tell which points ``(n, 2)`` mm are inside the region, by winding numbers."""
        found = np.zeros(len(points), np.bool_)
        if not self.contours:
            return found
        start = np.concatenate(self.contours)
        end = np.concatenate([np.roll(each, -1, axis=0) for each in self.contours])
        for first in range(0, len(points), _POINTS):
            x, y = (each[:, None] for each in points[first : first + _POINTS].T)
            side = (end - start)[:, 0] * (y - start[:, 1]) - (end - start)[:, 1] * (x - start[:, 0])
            up = (start[:, 1] <= y) & (end[:, 1] > y) & (side > 0.0)
            down = (start[:, 1] > y) & (end[:, 1] <= y) & (side < 0.0)
            found[first : first + _POINTS] = up.sum(axis=1) > down.sum(axis=1)
        return found


def contours_of(region: "CrossSection") -> Contours:
    """Return the outlines of a region, simplified by at most 0.003 mm."""
    return _with_boxes([np.asarray(contour) for contour in region.simplify(_SMOOTH).to_polygons()])


def contours_at(sliced: PlaneContours, plane: int) -> Contours:
    """Return the contours in a plane, simplified by at most 0.003 mm."""
    from amprep.kernels.slicing.straight import keep_bends

    own = np.flatnonzero(sliced.plane == plane)
    sizes = sliced.first[own + 1] - sliced.first[own]
    first = np.append(0, np.cumsum(sizes))
    points = sliced.points[np.arange(first[-1]) + np.repeat(sliced.first[own] - first[:-1], sizes)]
    kept = np.zeros(len(points), np.bool_)
    keep_bends(points, first, _SMOOTH, kept)
    bends, ends = points[kept], np.append(0, np.cumsum(kept))[first].tolist()
    return _with_boxes([bends[start:end] for start, end in pairwise(ends) if end > start + 2])


def _with_boxes(contours: list[Floats]) -> Contours:
    """Return contours with their boxes."""
    if not contours:
        return Contours([], np.empty((0, 2)), np.empty((0, 2)))
    points, first = np.concatenate(contours), np.cumsum([0, *map(len, contours[:-1])])
    return Contours(contours, np.minimum.reduceat(points, first), np.maximum.reduceat(points, first))


def find_thin_rests(
    region: Contours,
    width: float,
    area: float,
    is_kept: "Callable[[CrossSection], bool]",
    are_held: Callable[[Floats], Bools],
    judged: Callable[[Floats], Bools],
    *,
    waists: bool = True,
) -> "list[CrossSection]":
    """Return the pieces of a section that are thinner than a width, and whole pieces that are smaller than an area.

    Parameters
    ----------
    region
        The section.
    width, area
        Least width (mm) and least area (mm2).
    is_kept
        Tells whether a piece may stay though it is thin.
    are_held
        Tells at which points ``(k, 2)`` mm pieces may stay, so that no narrow end there is looked at.
    judged
        Tells at which points ``(k, 2)`` mm the section is judged; elsewhere it may be cut off.
    waists
        Whether waists are looked for, too.
    """
    found: list[CrossSection] = []
    whole, ends = region, narrow_ends(region, width, area, judged, waists=waists)
    ends = ends[~are_held(ends)]
    for _ in range(_ROUNDS):
        cut = _rests_at(region, ends, width, area, is_kept) if len(ends) else []
        if not cut:
            break
        found += cut
        low, high = bounds_of(cut)
        around = 2.0 * _AROUND * width
        left = whole.inside(low - around, high + around) - union_of(found).offset(_SMOOTH)
        region = contours_of(left)
        near = partial(are_in, low=low - width, high=high + width)
        ends = narrow_ends(region, width, area, near)
        ends = ends[judged(ends)]
        ends = ends[~are_held(ends)]
    return found


def _rests_at(
    region: Contours,
    ends: Floats,
    width: float,
    area: float,
    is_kept: "Callable[[CrossSection], bool]",
) -> "list[CrossSection]":
    """Return the rests in the squares around narrow places ``(k, 2)`` mm, or everywhere if there are many of them."""
    half = _AROUND * width
    judged = half - _BORDER * width
    centres = _apart(ends, half / 2.0)
    if len(centres) > _MOST_SQUARES:
        whole = region.whole()
        near = union_of([box(end - judged, end + judged) for end in centres])
        found = _pieces_of(_beyond_discs(whole, width) ^ near)
        found += [
            each for each in _inside(whole.decompose(), centres, half) if _is_too_small(each, width, area)
        ]
        return [rest for rest in found if not is_kept(rest)]
    found = []
    for end in centres:
        local = region.inside((end - half)[None], (end + half)[None])
        found += _pieces_of(_beyond_discs(local, width) ^ box(end - judged, end + judged))
        found += [
            each for each in _inside(local.decompose(), [end], half) if _is_too_small(each, width, area)
        ]
    return [rest for rest in found if not is_kept(rest)]


def _is_too_small(piece: "CrossSection", width: float, area: float) -> bool:
    """Tell whether a piece is smaller than an area, or so narrow that no disc of the width fits into it."""
    if piece.area() < area:
        return True
    contours = [np.asarray(contour) for contour in piece.to_polygons()]
    around = sum(float(np.hypot(*(each - np.roll(each, -1, axis=0)).T).sum()) for each in contours)
    is_narrow = 2.0 * piece.area() < _NARROW * width * around
    return bool(is_narrow and piece.offset(-width / 2.0).is_empty())


def _apart(points: Floats, distance: float) -> list[Floats]:
    """Return points ``(k, 2)`` mm of which none is in the square around an earlier one."""
    chosen = np.empty((0, 2))
    for point in points:
        if not len(chosen) or (np.abs(chosen - point) >= distance).any(axis=1).all():
            chosen = np.concatenate([chosen, point[None]])
    return list(chosen)


def _pieces_of(region: "CrossSection") -> "list[CrossSection]":
    """Return the pieces of a region but what offsets leave by rounding."""
    return [piece for piece in region.decompose() if piece.area() > _SPECK] if region.area() > _SPECK else []


def _beyond_discs(region: "CrossSection", width: float) -> "CrossSection":
    """Return what reaches beyond the discs of a width that fit into a region, farther than corners do."""
    from manifold3d import JoinType

    discs = region.offset(-width / 2.0)
    return region - discs.offset((0.5 + _CORNER) * width, JoinType.Round, 2.0, _SEGMENTS)


def everywhere(points: Floats) -> Bools:
    """Choose all points ``(k, 2)``."""
    return np.ones(len(points), np.bool_)


def narrow_ends(
    region: Contours,
    width: float,
    area: float = 0.0,
    judged: Callable[[Floats], Bools] = everywhere,
    *,
    waists: bool = True,
) -> Floats:
    """Return the points ``(k, 2)`` mm at which the outline of a region turns back within a width.

    Those of pieces that are smaller than an area (mm2), those of small pieces that may be too thin, and the corners at
    waists are among them.

    Parameters
    ----------
    region
        A region.
    width, area
        Length (mm) of the outline within which it turns, and area (mm2).
    judged
        Tells which points ``(k, 2)`` mm are looked at.
    waists
        Whether corners at waists are among the points.
    """
    contours = region.contours
    if not contours:
        return np.empty((0, 2))
    points = np.concatenate(contours)
    sizes = np.array([len(contour) for contour in contours])
    first = np.repeat(np.cumsum(sizes) - sizes, sizes)
    after = np.arange(1, len(points) + 1)
    after = np.where(after == first + np.repeat(sizes, sizes), first, after)
    side = points[after] - points
    length = np.hypot(side[:, 0], side[:, 1])
    looked_at = ~np.repeat(_are_compact(region, side, width, area), sizes)
    heading = np.arctan2(side[:, 1], side[:, 0])
    turn = np.empty(len(points))
    turn[after] = (heading[after] - heading + np.pi) % (2.0 * np.pi) - np.pi
    cross = points[:, 0] * points[after, 1] - points[:, 1] * points[after, 0]
    enclosed = np.add.reduceat(cross, np.cumsum(sizes) - sizes) / 2.0
    around = np.add.reduceat(length, np.cumsum(sizes) - sizes)
    is_stubby = (around < _SHORT * width) & (2.0 * enclosed < _STUBBY * width * around)
    is_narrow = 2.0 * enclosed < _NARROW * width * around
    is_small = np.repeat((enclosed > 0.0) & ((enclosed < area) | is_stubby | is_narrow), sizes) & looked_at
    ends = _turns_back(turn, length, after, width) & looked_at
    inwards = (turn < -INWARDS) & looked_at & waists
    narrow = keep_narrow(points, after, inwards, ends & ~is_small, width, judged)
    small = points[is_small]
    return np.concatenate([points[narrow & ~is_small], small[judged(small)]])


def _are_compact(region: Contours, side: Floats, width: float, area: float) -> Bools:
    """Tell which contours have no thin place for certain, because of the discs around their middle that fit, ``(k,)``.

    The middle is that of the box. Of a disc around it that fits, all discs of the width are inside, and they cover all
    that is nearer than their reach. `side` ``(n, 2)`` mm leads from each point to the next one.
    """
    points, sizes = np.concatenate(region.contours), [len(contour) for contour in region.contours]
    first = np.cumsum([0, *sizes[:-1]])
    offset = points - np.repeat((region.low + region.high) / 2.0, sizes, axis=0)
    cross = offset[:, 0] * side[:, 1] - offset[:, 1] * side[:, 0]
    length2 = np.maximum((side**2).sum(axis=1), 1e-18)
    along = np.clip(-(offset * side).sum(axis=1) / length2, 0.0, 1.0)
    near = np.hypot(*(offset + along[:, None] * side).T)
    # a contour that turns left around the middle everywhere contains it
    radius = np.where(np.minimum.reduceat(cross, first) > 0.0, np.minimum.reduceat(near, first), 0.0)
    farthest = np.maximum.reduceat(np.hypot(*offset.T), first)
    compact = (
        (radius > 0.51 * width) & (np.pi * radius**2 > area) & (farthest < radius + (_CORNER - 0.01) * width)
    )
    for hole in np.flatnonzero(np.add.reduceat(cross, first) <= 0.0).tolist():
        compact &= ~((region.low <= region.low[hole]) & (region.high >= region.high[hole])).all(axis=1)
    return np.asarray(compact)


def _turns_back(turn: Floats, length: Floats, after: np.ndarray, width: float) -> Bools:
    """Tell at which vertices a short stretch begins that turns back, ``(n,)``."""
    last = np.arange(len(turn))
    total, span = turn.copy(), np.zeros(len(turn))
    back = total > _TURN
    for _ in range(_VERTICES - 1):
        span += length[last]
        last = after[last]
        total += turn[last]
        back |= ((total > _TURN) & (span < width)) | ((total > _WEDGE) & (span < _WEDGE_SPAN * width))
    return np.asarray(back)


def bounds_of(pieces: "Sequence[CrossSection]") -> tuple[Floats, Floats]:
    """Return the corners of the boxes of pieces, ``(n, 2)`` mm."""
    low, high = np.split(np.array([piece.bounds() for piece in pieces]), 2, axis=1)
    return low, high


def are_in(points: Floats, low: Floats, high: Floats) -> Bools:
    """Tell which points ``(n, 2)`` mm are inside one of several rectangles with the corners ``(k, 2)`` mm."""
    inside = np.all((points[:, None] > low) & (points[:, None] < high), axis=2)
    return np.asarray(np.any(inside, axis=1))


def _inside(pieces: "Sequence[CrossSection]", centres: Sequence[Floats], half: float) -> "list[CrossSection]":
    """Return the pieces that are clearly inside one of the squares around centres ``(2,)`` mm."""
    if not pieces:
        return []
    low, high = bounds_of(pieces)
    inside = np.zeros(len(pieces), np.bool_)
    for centre in centres:
        inside |= ((low > centre - 0.99 * half) & (high < centre + 0.99 * half)).all(axis=1)
    return [pieces[each] for each in np.flatnonzero(inside).tolist()]
