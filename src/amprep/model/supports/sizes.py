"""Sizes of supports that judges need and the rules do not state."""

from dataclasses import dataclass, fields

from amprep.validation import require_bounds

_LARGEST = 1000.0
"""Largest size (mm)."""


@dataclass(frozen=True)
class SupportSizes:
    """Sizes of the supports of a build; all 0 where they are unknown.

    Attributes
    ----------
    square_mm
        Side of a square of the support grid.
    tip_width_mm, tip_height_mm
        Width at the part of teeth or points, and length over which they taper; 0 for connectors without tips.
    neck_mm
        Width of the necks of connectors; 0 for none.
    base_margin_mm, base_height_mm
        Margin of bases around the feet of supports, and their height; 0 for supports without bases.
    """

    square_mm: float = 0.0
    tip_width_mm: float = 0.0
    tip_height_mm: float = 0.0
    neck_mm: float = 0.0
    base_margin_mm: float = 0.0
    base_height_mm: float = 0.0

    def __post_init__(self) -> None:
        require_bounds(self, *(field.name for field in fields(self)), at_least=0, at_most=_LARGEST)

    def enlarged(self, other: "SupportSizes") -> "SupportSizes":
        """Return the larger of each of two sizes."""
        names = [field.name for field in fields(self)]
        return SupportSizes(**{name: max(getattr(self, name), getattr(other, name)) for name in names})
