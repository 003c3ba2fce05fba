"""Shrink regions, and tell how wide they are."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from manifold3d import CrossSection


def shrunk(region: "CrossSection", distance: float) -> "CrossSection":
    """Return a region without what is nearer than a distance (mm) to its outline.

    A sliver that rounding left makes the inward offset of all pieces empty, so then each piece is shrunk by itself.
    """
    from manifold3d import CrossSection

    whole = region.offset(-distance)
    if not whole.is_empty() or region.num_contour() < 2:
        return whole
    return CrossSection.compose([piece.offset(-distance) for piece in region.decompose()])


def is_wide(region: "CrossSection", width: float) -> bool:
    """Tell whether a region is somewhere at least so wide (mm)."""
    return not shrunk(region, width / 2.0).is_empty()
