"""The rules that the supports of a build are planned and judged by."""

from dataclasses import dataclass
from typing import Literal

from amprep.validation import require_bounds

Grounding = Literal["plate-only", "anywhere"]


@dataclass(frozen=True)
class SupportRules:
    """Rules that a build file records, so that its supports can be judged from the file alone.

    Attributes
    ----------
    overhang_angle_deg
        A face at a smaller angle to the plate needs support; a part's own angle takes precedence.
    strut_angle_deg
        Smallest angle to the plate of the support sections that lead sideways.
    min_area_mm2, min_length_mm
        Smaller overhanging faces and shorter edges need no support, unless the part would start in the air there.
    gap_mm
        Smallest XY distance between supports and walls of parts; 0 lets them touch.
    grounding
        ``plate-only``: all supports stand on the plate; ``anywhere``: a support without a path to the plate may
        stand on the part that it supports.
    """

    overhang_angle_deg: float = 45.0
    strut_angle_deg: float = 45.0
    min_area_mm2: float = 0.5
    min_length_mm: float = 0.5
    gap_mm: float = 0.0
    grounding: Grounding = "plate-only"

    def __post_init__(self) -> None:
        require_bounds(self, "overhang_angle_deg", at_least=0, at_most=89)
        require_bounds(self, "strut_angle_deg", at_least=10, at_most=80)
        require_bounds(self, "min_area_mm2", "min_length_mm", "gap_mm", at_least=0)
