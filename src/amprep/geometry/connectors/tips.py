"""The shape of teeth and points: shoulders that carry them, tapered bodies, necks."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.connectors.sites import Sites, within
from amprep.geometry.merging.union import union
from amprep.geometry.meshes.manifold import as_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold


ROUND_SIDES = 12
"""Of the polygon that stands for a circle."""

_APART = 2e-4
"""mm; tips of neighbouring cells keep twice that from each other."""

_OVER = 5e-4
"""mm; how far prisms reach over their cells."""

_ROOT = 0.05
"""Share of a cell that stays free on each side of a tip's root."""

_DIP = 0.05
"""mm; how far shapes reach below the connectors' base and above their top, where those cut them off."""


class TipProfile(NamedTuple):
    """Section of a tip from below: as wide as its cell, tapering to `width` over `height`, straight on up.

    Attributes
    ----------
    width, height
        mm.
    neck, neck_height
        mm; a neck of 0 is none. It lies `neck_height` below the lowest spot of the contact, in short tips half way.
    round
        Whether sections are circles, else squares; at the side of a cell they are squares.
    """

    width: float
    height: float
    neck: float
    neck_height: float
    round: bool


def tips(sites: Sites, profile: TipProfile, level: Floats, base: Floats, overlap: float) -> "Manifold":
    """Return a solid that leaves of connectors only teeth or points, on the shoulders that carry them.

    Each cell is filled up to its level; from there on the tip stands.

    Parameters
    ----------
    level, base
        ``(s,)`` mm, where the tip of each site begins, and its connector.
    overlap
        mm that connectors reach into the part.
    """
    from manifold3d import Manifold

    if not len(sites.column):
        return Manifold()
    rings = _rings(sites, profile, level, base, overlap)
    tall = level > base
    cells = sites.square[tall], sites.lo[tall], sites.hi[tall]
    return union([prisms(*cells, base[tall] - _DIP, level[tall]), as_manifold(*_lofted(rings))])


def prisms(square: Int64s, lo: Floats, hi: Floats, bottom: Floats, top: Floats) -> "Manifold":
    """Return the union of upright prisms over cells of a grid, which may be of several heights.

    They reach a hair over their cells, because manifold3d joins and cuts solids whose walls lie in each other
    less well; for the same reason every second cell of every second row goes into a mesh of its own.

    Parameters
    ----------
    square
        ``(n, 2)`` the cells' places in the grid.
    lo, hi
        ``(n, 2)`` mm, their corners in plan.
    """
    colour = square[:, 0] % 2 * 2 + square[:, 1] % 2
    solids = []
    for each in np.unique(colour):
        own = colour == each
        sides = [
            _ring(z[own], (lo[own], hi[own]), np.zeros(own.sum(), np.bool_), sides=4) for z in (bottom, top)
        ]
        solids.append(as_manifold(*_lofted(np.stack(sides, axis=1))))
    return union(solids)


def _rings(sites: Sites, profile: TipProfile, level: Floats, base: Floats, overlap: float) -> Floats:
    """Return the corners of each tip's sections from below, ``(s, r, n, 3)`` mm."""
    lo, hi = sites.lo + _APART, sites.hi - _APART
    top = within(sites.spot, profile.width, lo, hi)
    rim = _ROOT * (hi - lo)
    root = np.minimum(lo + rim, top[0]), np.maximum(hi - rim, top[1])
    # a circle that was pushed into its cell may miss the spot: a square does not
    pushed = np.linalg.norm((top[0] + top[1]) / 2.0 - sites.spot, axis=1) > 0.4 * profile.width
    circle = ~pushed & profile.round
    levels = [(level - _DIP, root, np.zeros_like(circle))]
    if profile.neck:
        neck = within(sites.spot, profile.neck, *top)
        height = np.maximum(sites.lowest - profile.neck_height, (sites.lowest + level) / 2.0)
        levels.append((height, neck, circle))
    levels += [(sites.lowest, top, circle), (sites.highest + overlap + _DIP, top, circle)]
    rings = np.stack([_ring(*level, sides=ROUND_SIDES if profile.round else 4) for level in levels], axis=1)
    return _shortened(rings, base - 2 * _DIP)


def _shortened(rings: Floats, floor: Floats) -> Floats:
    """Let tips begin at the floor that is cut away anyway: there may be other connectors further below."""
    low, high = rings[:, 0, 0, 2], rings[:, 1, 0, 2]
    deep = np.flatnonzero((low < floor) & (floor < high))
    share = ((floor - low)[deep] / (high - low)[deep])[:, None, None]
    rings[deep, 0] += share * (rings[deep, 1] - rings[deep, 0])
    return rings


def _ring(z: Floats, box: tuple[Floats, Floats], circle: Bools, *, sides: int) -> Floats:
    """Return points ``(s, sides, 3)`` on the sides of boxes, or on the circles in them, counter-clockwise."""
    angle = np.pi / 4 + 2 * np.pi * np.arange(sides) / sides
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    square = way / np.abs(way).max(axis=1)[:, None]
    middle, half = (box[0] + box[1]) / 2.0, (box[1] - box[0]) / 2.0
    plan = middle[:, None] + half[:, None] * np.where(circle[:, None, None], way, square)
    return np.concatenate([plan, np.broadcast_to(z[:, None, None], (len(z), sides, 1))], axis=2)


def _lofted(rings: Floats) -> tuple[Floats, Int64s]:
    """Return closed meshes through rings ``(s, r, n, 3)``, each one's from below upwards."""
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
