"""Outlines: shadows without what no other part could use, as polygons, convex pieces and hull."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.boxes.footprint import convex_outline
from amprep.geometry.plates.convex import convex_pieces
from amprep.geometry.plates.outward import simplify_outward
from amprep.geometry.plates.shadow import SEGMENTS

if TYPE_CHECKING:
    from manifold3d import CrossSection

EXACT = 1e-5
"""Distance (mm) up to which corners are left out first, on both sides of the outline."""


@dataclass(frozen=True, eq=False)
class ShadowOutline:
    """A region of the plate relative to the centre of its enclosing box.

    Attributes
    ----------
    loops
        ``(k, 2)`` mm, disjoint polygons with the inside to their left.
    half
        ``(2,)`` mm, half the sides of the enclosing box.
    """

    loops: tuple[Floats, ...]
    half: Floats

    @cached_property
    def pieces(self) -> tuple[Floats, ...]:
        """Convex polygons ``(k, 2)`` mm, whose union is the region."""
        return tuple(convex_pieces(self.loops))

    @cached_property
    def area(self) -> float:
        """Area (mm2)."""
        return float(sum(signed_area(loop) for loop in self.loops))

    @cached_property
    def is_connected(self) -> bool:
        """Whether it has one component."""
        return sum(signed_area(loop) > 0.0 for loop in self.loops) == 1

    @cached_property
    def hull(self) -> Floats:
        """Corners ``(k, 2)`` mm of the convex hull."""
        return convex_outline(np.concatenate(self.loops))


def closed(shadow: "CrossSection", radius: float) -> "CrossSection":
    """Return a region without the holes and gaps that a disc of a radius (mm) cannot enter.

    If a clearance of this radius is kept to others, the result is as far from them as the region itself: points nearer
    than the clearance to one are nearer to the other.
    """
    from manifold3d import JoinType

    if radius <= 0.0:
        return shadow
    wider = shadow.offset(radius, JoinType.Round, 2.0, SEGMENTS)
    return wider.offset(-radius, JoinType.Round, 2.0, SEGMENTS) + shadow


def outline_of(
    region: "CrossSection", low: Floats, high: Floats, clearance: float, tolerance: float
) -> ShadowOutline:
    """Return the outline of a region relative to the centre of its enclosing box.

    Parameters
    ----------
    low, high
        ``(2,)`` mm, corners of the enclosing box.
    clearance
        Least distance of other outlines, mm; what they cannot enter is filled.
    tolerance
        Length (mm) by which the outline may be outside the region; it is never outside the box.
    """
    from manifold3d import CrossSection, FillRule

    filled = closed(region.simplify(EXACT), clearance).simplify(EXACT)
    loops = [np.asarray(loop) for loop in filled.to_polygons()]
    simple = CrossSection(simplify_outward(loops, tolerance), FillRule.Positive)
    box = CrossSection.square((high - low).tolist()).translate(low.tolist())
    centre = (low + high) / 2.0
    polygons = (np.asarray(loop) - centre for loop in (simple ^ box).to_polygons())
    return ShadowOutline(tuple(polygons), (high - low) / 2.0)


def rectangle(low: Floats, high: Floats) -> ShadowOutline:
    """Return a rectangle relative to its centre."""
    x, y = (high - low) / 2.0
    return ShadowOutline((np.array([[-x, -y], [x, -y], [x, y], [-x, y]]),), np.array([x, y]))


def sides_of(loops: Sequence[Floats]) -> Floats:
    """Return the sides of polygons, ``(k, 4)``: start and end."""
    return np.concatenate([np.hstack((loop, np.roll(loop, -1, axis=0))) for loop in loops])


def signed_area(loop: Floats) -> float:
    """Return the area (mm2) of a polygon ``(k, 2)``, negative if it is clockwise."""
    following = np.roll(loop, -1, axis=0)
    return float((loop[:, 0] * following[:, 1] - loop[:, 1] * following[:, 0]).sum() / 2.0)
