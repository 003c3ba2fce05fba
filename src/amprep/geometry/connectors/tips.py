"""Shape teeth and points: the shoulders below them, their tapered bodies and break-away necks."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.connectors.fitting import ROOT, root_of
from amprep.geometry.connectors.sites import Sites, squares_in_cells
from amprep.geometry.merging.union import union
from amprep.geometry.meshes.manifold import as_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold


ROUND_SIDES = 12
"""Number of sides of the polygon that approximates a circle."""

_APART = 2e-4
"""Distance (mm) between a tip and the side of its cell; tips of neighbouring cells are twice as far apart."""

_DIP = 0.05
"""Length (mm) by which shapes extend below the base and above the top of the connectors, which then clip them."""


_SAME = 1e-9
"""Length (mm) by which prisms may differ that become one."""


class TipProfile(NamedTuple):
    """Section of a tip: from the width of its cell it tapers to `width` over `height`, and then continues upwards.

    Attributes
    ----------
    width, height
        Width at the part and length of the taper, mm.
    neck, neck_height
        Width of the break-away neck (0 for none) and its distance below the lowest point of the contact, mm. In a tip
        shorter than twice that distance the neck is halfway up.
    round
        True for circular sections, False for squares. A circle that would leave its cell becomes a square.
    """

    width: float
    height: float
    neck: float
    neck_height: float
    round: bool


def make_tips(
    sites: Sites, profile: TipProfile, level: Floats, base: Floats, plate: Floats, overlap: float
) -> "Manifold":
    """Return the solid whose intersection with plain connectors is teeth or points on their shoulders.

    The shoulder of a site is its whole cell from the base up to the level; the tip begins at the level. Where contact
    covers only a part of the cell, a strip of a shoulder could be thin: there it ends at the plate, and the tip begins.

    Parameters
    ----------
    sites
        Places of the tips.
    profile
        Section that all tips share.
    level, base
        ``(s,)`` heights (mm) at which the tip and the connector of each site begin.
    plate
        ``(s,)`` mm, the lowest level in the column of each site.
    overlap
        Depth (mm) to which connectors enter the part.
    """
    from manifold3d import Manifold

    if not len(sites.column):
        return Manifold()
    rings = _rings(sites, profile, level, base, overlap)
    shoulder = np.where(sites.whole, level, np.minimum(plate, level))
    has_stem = shoulder < level - _DIP
    stems = rings[has_stem]
    low = stems[:, :1].copy()
    low[:, :, :, 2] = np.maximum(shoulder - _DIP, base - 2 * _DIP)[has_stem, None, None]
    stems = np.concatenate([low, stems], axis=1)
    tall = shoulder > base
    cells = sites.square[tall], sites.lo[tall], sites.hi[tall]
    prisms = grid_prisms(*cells, base[tall] - _DIP, shoulder[tall])
    return union([prisms, *(as_manifold(*_lofted(each)) for each in (rings[~has_stem], stems) if len(each))])


def grid_prisms(square: Int64s, lo: Floats, hi: Floats, bottom: Floats, top: Floats) -> "Manifold":
    """Return the union of upright prisms of various heights over squares of a grid.

    Neighbours of equal height in a row become one prism. Walls of neighbouring prisms coincide, and a mesh with
    coincident walls is not a valid solid. Therefore four meshes are united, each of which has no two neighbours.

    Parameters
    ----------
    square
        ``(n, 2)`` indices y, x of the squares in the grid.
    lo, hi
        ``(n, 2)`` mm, corners of the prisms in plan, in their squares or a little wider.
    bottom, top
        ``(n,)`` mm, heights at which the prisms begin and end.
    """
    order = np.lexsort([square[:, 1], square[:, 0]])
    square, lo, hi = square[order], lo[order], hi[order]
    bottom, top = bottom[order], top[order]
    begins = np.ones(len(square) + 1, np.bool_)
    begins[1:-1] = ~(
        (np.diff(square[:, 0]) == 0)
        & (np.diff(square[:, 1]) == 1)
        & (lo[1:, 0] <= hi[:-1, 0] + _SAME)
        & (np.abs(np.diff(np.column_stack([lo[:, 1], hi[:, 1], bottom, top]), axis=0)) <= _SAME).all(axis=1)
    )
    first, last = np.flatnonzero(begins[:-1]), np.flatnonzero(begins[1:])
    square, lo, hi, bottom, top = square[first], lo[first], hi[last], bottom[first], top[first]
    in_row = np.arange(len(square)) - np.searchsorted(square[:, 0], square[:, 0])
    colour = square[:, 0] % 2 * 2 + in_row % 2
    solids = []
    for each in np.unique(colour):
        own = colour == each
        sides = [
            _ring(z[own], (lo[own], hi[own]), np.zeros(own.sum(), np.bool_), sides=4) for z in (bottom, top)
        ]
        solids.append(as_manifold(*_lofted(np.stack(sides, axis=1))))
    return union(solids)


def _rings(sites: Sites, profile: TipProfile, level: Floats, base: Floats, overlap: float) -> Floats:
    """Return the sections of each tip as rings of corners from the root upwards, ``(s, r, n, 3)`` mm."""
    lo, hi = sites.lo + _APART, sites.hi - _APART
    width = sites.width[:, None]
    top = squares_in_cells(sites.spot, width, lo, hi)
    inside = sites.inside[:, None]
    top = (
        np.where(inside, top[0], sites.spot - width / 2.0),
        np.where(inside, top[1], sites.spot + width / 2.0),
    )
    rim = ROOT * (hi - lo)
    root = root_of(top, lo + rim, hi - rim, sites.spread[:, None])
    # a circle that was moved into its cell may miss the contact point; a square does not
    pushed = np.linalg.norm((top[0] + top[1]) / 2.0 - sites.spot, axis=1) > 0.4 * sites.width
    circle = ~pushed & profile.round
    levels = [(level - _DIP, root, circle & (sites.spread == 0.0))]
    if profile.neck:
        neck = squares_in_cells(sites.spot, np.minimum(profile.neck, width), *top)
        height = np.maximum(sites.lowest - profile.neck_height, (sites.lowest + level) / 2.0)
        levels.append((height, neck, circle))
    levels += [(sites.lowest, top, circle), (sites.highest + overlap + _DIP, top, circle)]
    rings = np.stack([_ring(*level, sides=ROUND_SIDES if profile.round else 4) for level in levels], axis=1)
    return _shortened(rings, base - 2 * _DIP)


def _shortened(rings: Floats, floor: Floats) -> Floats:
    """Move the root of each tip up to the floor, because other connectors may be further below."""
    low, high = rings[:, 0, 0, 2], rings[:, 1, 0, 2]
    deep = np.flatnonzero((low < floor) & (floor < high))
    fraction = ((floor - low)[deep] / (high - low)[deep])[:, None, None]
    rings[deep, 0] += fraction * (rings[deep, 1] - rings[deep, 0])
    return rings


def _ring(z: Floats, box: tuple[Floats, Floats], circle: Bools, *, sides: int) -> Floats:
    """Return the corners of squares or inscribed circles at height `z`, ``(s, sides, 3)``, counter-clockwise."""
    angle = np.pi / 4 + 2 * np.pi * np.arange(sides) / sides
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    square = ray / np.abs(ray).max(axis=1)[:, None]
    middle, half = (box[0] + box[1]) / 2.0, (box[1] - box[0]) / 2.0
    plan = middle[:, None] + half[:, None] * np.where(circle[:, None, None], ray, square)
    return np.concatenate([plan, np.broadcast_to(z[:, None, None], (len(z), sides, 1))], axis=2)


def _lofted(rings: Floats) -> tuple[Floats, Int64s]:
    """Return closed meshes that join consecutive rings ``(s, r, n, 3)``, ordered from below."""
    count, levels, sides, _ = rings.shape
    here = np.arange(sides)
    after = (here + 1) % sides
    faces = [np.column_stack([0 * here[1:-1], after[1:-1], here[1:-1]])]
    for low in sides * np.arange(levels - 1):
        high = low + sides
        faces += [np.column_stack([low + here, low + after, high + after]),
                  np.column_stack([low + here, high + after, high + here])]  # fmt: skip
    last = sides * (levels - 1)
    faces.append(last + np.column_stack([0 * here[1:-1], here[1:-1], after[1:-1]]))
    one = np.concatenate(faces)
    every = one[None] + (levels * sides * np.arange(count))[:, None, None]
    return rings.reshape(-1, 3), every.reshape(-1, 3)
