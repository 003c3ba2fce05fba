"""Shapes in plan: rectangles, unions, flanges and rafts."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold


SOLE = 0.01
"""Height (mm) above the plate at which the feet of a support are sliced."""

_SIDES = 48
"""Number of sides of the polygon that approximates a circle."""

_TINY = 1e-3
"""Side (mm) of the squares that represent points in boolean operations."""


def feet_of(support: "Manifold") -> "CrossSection":
    """Return the section of a support at the plate."""
    return support.slice(SOLE)


def shadow(solid: "Manifold", height: float) -> "CrossSection":
    """Return the projection onto the plate of the part of a solid below `height` mm."""
    return solid.trim_by_plane((0.0, 0.0, -1.0), -height).project()


def grown(plan: "CrossSection", by: float) -> "CrossSection":
    """Return a shape offset outwards by `by` mm with round corners; a negative value shrinks it."""
    from manifold3d import JoinType

    return plan.offset(by, JoinType.Round, 2.0, _SIDES)


def raft(feet: "CrossSection", margin: float) -> "CrossSection":
    """Return a plate with `margin` mm around the feet; it joins feet up to six margins apart."""
    return grown(grown(feet, 3.0 * margin), -2.0 * margin)


def plate(size: Floats, *, disc: bool) -> "CrossSection":
    """Return the build plate, a disc as its inscribed polygon."""
    from manifold3d import CrossSection

    if not disc:
        return CrossSection.square(size[:2].tolist())
    radius = float(size[0]) / 2.0
    return CrossSection.circle(radius, 4 * _SIDES).translate((radius, radius))


def box(lo: Floats, hi: Floats) -> "CrossSection":
    """Return the rectangle between two corners."""
    from manifold3d import CrossSection

    return CrossSection.square((hi - lo)[:2].tolist()).translate(lo[:2].tolist())


def union_of(plans: Sequence["CrossSection"]) -> "CrossSection":
    """Return the union of shapes."""
    from manifold3d import CrossSection, OpType

    return CrossSection.batch_boolean(list(plans), OpType.Add) if plans else CrossSection()


def below_feet(plan: "CrossSection", feet: "CrossSection") -> "CrossSection":
    """Return the connected pieces of a shape that contain a part of the feet."""
    return union_of([piece for piece in plan.decompose() if not (piece ^ feet).is_empty()])


def perforated(plan: "CrossSection", feet: "CrossSection", diameter: float) -> "CrossSection":
    """Return a plate with round holes on a square lattice of pitch ``2 * diameter``.

    Holes are at least half a diameter away from the feet and from the rim of the plate.
    """
    from manifold3d import CrossSection

    room = grown(plan, -diameter) - grown(feet, diameter)
    if room.is_empty():
        return plan
    x0, y0, x1, y1 = room.bounds()
    x, y = (
        np.arange(np.ceil(low / diameter / 2), high / diameter / 2) * 2 * diameter
        for low, high in ((x0, x1), (y0, y1))
    )
    dot = CrossSection.square((_TINY, _TINY), center=True)
    dots = [dot.translate((float(a), float(b))) for a in x for b in y]
    centres = [np.asarray(each).mean(axis=0) for each in (CrossSection.compose(dots) ^ room).to_polygons()]
    disc = CrossSection.circle(diameter / 2.0, _SIDES // 3)
    return plan - CrossSection.compose([disc.translate(centre.tolist()) for centre in centres])
