"""Shapes in plan of what supports stand on at the plate: flanges around feet, pads under them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold


SOLE = 0.01
"""mm above the plate at which the feet of a support are measured."""

_SIDES = 48
"""Of the polygon that stands for a whole circle."""

_TINY = 1e-3
"""mm; the side of squares that stand for points in booleans."""


def feet_of(support: "Manifold") -> "CrossSection":
    """Return the section of a support at the plate."""
    return support.slice(SOLE)


def shadow(solid: "Manifold", height: float) -> "CrossSection":
    """Return what of the plate lies below the part of a solid that is lower than `height` mm."""
    return solid.trim_by_plane((0.0, 0.0, -1.0), -height).project()


def grown(plan: "CrossSection", by: float) -> "CrossSection":
    """Return a shape with all that is at most `by` mm from it; less than 0 shrinks it."""
    from manifold3d import JoinType

    return plan.offset(by, JoinType.Round, 2.0, _SIDES)


def raft(feet: "CrossSection", margin: float) -> "CrossSection":
    """Return a pad that reaches `margin` beyond feet and joins those that are up to six margins apart."""
    return grown(grown(feet, 3.0 * margin), -2.0 * margin)


def plate(size: Floats, *, disc: bool) -> "CrossSection":
    """Return the plate of a build volume, a disc as the polygon inside it."""
    from manifold3d import CrossSection

    if not disc:
        return CrossSection.square(size[:2].tolist())
    radius = float(size[0]) / 2.0
    return CrossSection.circle(radius, 4 * _SIDES).translate((radius, radius))


def box(lo: Floats, hi: Floats) -> "CrossSection":
    """Return the rectangle between two corners."""
    from manifold3d import CrossSection

    return CrossSection.square((hi - lo)[:2].tolist()).translate(lo[:2].tolist())


def sum_of(plans: Sequence["CrossSection"]) -> "CrossSection":
    """Return the union of shapes."""
    from manifold3d import CrossSection, OpType

    return CrossSection.batch_boolean(list(plans), OpType.Add) if plans else CrossSection()


def standing(plan: "CrossSection", feet: "CrossSection") -> "CrossSection":
    """Return those pieces of a shape that have feet on them."""
    return sum_of([piece for piece in plan.decompose() if not (piece ^ feet).is_empty()])


def perforated(pad: "CrossSection", feet: "CrossSection", hole: float) -> "CrossSection":
    """Return a pad with round holes, two diameters apart from middle to middle.

    They keep half a diameter away from feet and from the pad's rim.
    """
    from manifold3d import CrossSection

    room = grown(pad, -hole) - grown(feet, hole)
    if room.is_empty():
        return pad
    x0, y0, x1, y1 = room.bounds()
    x, y = (
        np.arange(np.ceil(low / hole / 2), high / hole / 2) * 2 * hole for low, high in ((x0, x1), (y0, y1))
    )
    dot = CrossSection.square((_TINY, _TINY), center=True)
    dots = [dot.translate((float(a), float(b))) for a in x for b in y]
    middles = [np.asarray(each).mean(axis=0) for each in (CrossSection.compose(dots) ^ room).to_polygons()]
    disc = CrossSection.circle(hole / 2.0, _SIDES // 3)
    return pad - CrossSection.compose([disc.translate(middle.tolist()) for middle in middles])
