"""Find what is too thin in a horizontal section of a solid, from the narrow ends of its outline."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.plates.inward import shrunk
from amprep.geometry.supports.footprints import box, union_of
from amprep.geometry.supports.narrow_ends import CORNER, NARROW, everywhere, narrow_ends
from amprep.geometry.supports.outlines import SMOOTH, Contours, contours_of

if TYPE_CHECKING:
    from manifold3d import CrossSection

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

# Strategy. Offsets of whole sections take most of the time of a test for thin places, so they are taken only there
# where the outline tells that something may be thin.
# 1. A narrow end (of a fin, or of a thin piece) is a short stretch of the outline that turns by nearly 180 degrees. A
#    waist between two wide places has a corner that turns inwards, near to which another side of the outline is.
#    What discs of the width near it cover is no such place.
# 2. In a square around each of them, the rest is what discs of the least width, grown by the reach of corners, do
#    not cover. Near the border of the square, which cuts the region, nothing is judged. Only the outlines whose boxes
#    meet the square are cut to it: no other outline encloses a point of it.
# 3. Where the rest is cut away, the next narrow end of a long fin appears; so steps 1 and 2 are repeated there.


def find_thin_rests(
    region: Contours,
    ends: Floats,
    width: float,
    area: float,
    is_kept: "Callable[[CrossSection], bool]",
    are_held: Callable[[Floats], Bools],
    judged: Callable[[Floats], Bools] = everywhere,
) -> "list[CrossSection]":
    """Return the pieces of a section that are thinner than a width, and whole pieces that are smaller than an area.

    Parameters
    ----------
    region
        The section.
    ends
        Narrow ends of the section ``(k, 2)`` mm, see `narrow_ends`, without those at which pieces may stay.
    width, area
        Least width (mm) and least area (mm2).
    is_kept
        Tells whether a piece may stay though it is thin.
    are_held
        Tells at which points ``(k, 2)`` mm pieces may stay, so that no narrow end there is looked at.
    judged
        Tells at which points ``(k, 2)`` mm the section is judged; elsewhere it may be cut off.
    """
    found: list[CrossSection] = []
    whole = region
    for _ in range(_ROUNDS):
        cut = _rests_at(region, ends, width, area, is_kept) if len(ends) else []
        if not cut:
            break
        found += cut
        low, high = bounds_of(cut)
        around = 2.0 * _AROUND * width
        left = whole.inside(low - around, high + around) - union_of(found).offset(SMOOTH)
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
    is_narrow = 2.0 * piece.area() < NARROW * width * around
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

    discs = shrunk(region, width / 2.0)
    return region - discs.offset((0.5 + CORNER) * width, JoinType.Round, 2.0, _SEGMENTS)


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
