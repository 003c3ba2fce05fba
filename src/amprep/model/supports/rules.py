"""The rules that the supports of a build are planned and judged by.

The job's section ``[supports]`` inherits from these records, so the names of the fields are the keys of the job file.
The defaults here are the rules of the thesis, which has no limits; a job takes its defaults from its material profile.
"""

from dataclasses import dataclass
from typing import Literal

from amprep.validation import require, require_bounds

Grounding = Literal["plate-only", "anywhere"]
OverhangJudgement = Literal["limits", "thesis"]
Territory = Literal["own", "shared"]

ON_PLATE = 1e-3
"""Least height (mm) up to which geometry counts as on the plate."""

LARGEST_LIMIT = 1000.0
"""Largest limit (mm) of ledges, bridges, bores, contacts and drift."""


@dataclass(frozen=True)
class OverhangRules:
    """What needs support.

    Attributes
    ----------
    rules
        ``limits``: the angle, and the limits up to which the part itself carries an overhang; ``thesis``: the angle
        alone (thesis 3.1).
    overhang_angle_deg
        A face at a smaller angle to the plate needs support; a part's own angle takes precedence.
    noncritical_angle_deg
        Faces from the overhang angle up to this angle need no support, but are listed as worth a check; 0 for none.
    ledge_mm
        Largest horizontal distance from the border that carries an overhang on one side.
    bridge_mm
        Largest span between borders that carry an overhang on two sides.
    bore_mm
        Largest diameter of horizontal bores, and of other arches with the same width flatter than the overhang angle.
    plate_mm
        Height up to which geometry is on the plate.
    layer_mm
        Height of a printed layer.
    min_area_mm2, min_length_mm
        With ``thesis``: smaller overhanging faces and shorter edges need no support, unless the part would start in
        the air there. With both: unsupported patches and stretches below it are minor beside supported surface.
    """

    rules: OverhangJudgement = "thesis"
    overhang_angle_deg: float = 45.0
    noncritical_angle_deg: float = 0.0
    ledge_mm: float = 0.0
    bridge_mm: float = 0.0
    bore_mm: float = 0.0
    plate_mm: float = ON_PLATE
    layer_mm: float = 0.04
    min_area_mm2: float = 0.5
    min_length_mm: float = 0.5

    def __post_init__(self) -> None:
        require_bounds(self, "overhang_angle_deg", "noncritical_angle_deg", at_least=0, at_most=89)
        require_bounds(self, "ledge_mm", "bridge_mm", "bore_mm", at_least=0, at_most=LARGEST_LIMIT)
        require_bounds(self, "plate_mm", at_least=ON_PLATE, at_most=1.0)
        require_bounds(self, "layer_mm", at_least=0.005, at_most=2.0)
        require_bounds(self, "min_area_mm2", "min_length_mm", at_least=0)

    def require_noncritical(self) -> None:
        """Raise `ValueError` if the second angle is below the overhang angle, where it would do nothing.

        Build files of earlier releases may record such an angle, so only jobs and profiles are checked.
        """
        require(
            self.noncritical_angle_deg == 0 or self.noncritical_angle_deg >= self.overhang_angle_deg,
            f"noncritical_angle_deg must be 0 or at least overhang_angle_deg = {self.overhang_angle_deg:g}",
            f"{self.noncritical_angle_deg:g}",
        )

    @property
    def has_limits(self) -> bool:
        """Whether overhangs that the part itself carries need no support."""
        return self.rules == "limits"


@dataclass(frozen=True)
class SectionRules:
    """How thin and how slender supports may be, and how near to each other their contacts.

    Attributes
    ----------
    least_wall_mm
        Least thickness of a support; 0 for none.
    least_contact_mm2
        Least area of a connected piece of a horizontal section of a support; 0 for none.
    leg_ratio
        Largest ratio of length to width of a leg, a stretch of support without a brace or wall beside it; 0 for no
        limit.
    contact_spacing_mm
        Largest distance between neighbouring contacts on flat overhangs; 0 for that of the support grid.
    """

    least_wall_mm: float = 0.0
    least_contact_mm2: float = 0.0
    leg_ratio: float = 0.0
    contact_spacing_mm: float = 0.0

    def __post_init__(self) -> None:
        require_bounds(self, "least_wall_mm", at_least=0, at_most=5.0)
        require_bounds(self, "least_contact_mm2", at_least=0, at_most=25.0)
        require(
            self.leg_ratio == 0 or self.leg_ratio >= 1, "leg_ratio must be 0 or at least 1", self.leg_ratio
        )
        require_bounds(self, "leg_ratio", at_most=LARGEST_LIMIT)
        require_bounds(self, "contact_spacing_mm", at_least=0, at_most=LARGEST_LIMIT)


@dataclass(frozen=True)
class TerritoryRules:
    """Where supports may be.

    Attributes
    ----------
    territory
        ``own``: inside the shadow of their part grown by a margin, and outside the shadows of others; ``shared``:
        anywhere in the build volume (thesis).
    territory_margin_mm
        Margin around the shadow of a part.
    drift_ratio, drift_mm
        Largest horizontal distance of a support from an overhang above it that it carries: a fraction of the height
        between them, and an absolute limit; only with ``own``. 0 for no limit.
    gap_mm
        Smallest XY distance between supports and walls of parts; 0 lets them touch.
    grounding
        ``plate-only``: all supports stand on the plate; ``anywhere``: a support without a path to the plate may
        stand on the part that it supports.
    """

    territory: Territory = "shared"
    territory_margin_mm: float = 0.0
    drift_ratio: float = 0.0
    drift_mm: float = 0.0
    gap_mm: float = 0.0
    grounding: Grounding = "plate-only"

    def __post_init__(self) -> None:
        require_bounds(self, "territory_margin_mm", "drift_mm", at_least=0, at_most=LARGEST_LIMIT)
        require_bounds(self, "drift_ratio", at_least=0, at_most=10.0)
        require_bounds(self, "gap_mm", at_least=0)


@dataclass(frozen=True)
class SupportRules(OverhangRules, SectionRules, TerritoryRules):
    """Rules that a build file records, so that its supports can be judged from the file alone.

    Attributes
    ----------
    strut_angle_deg
        Smallest angle to the plate of the support sections that lead sideways.
    """

    strut_angle_deg: float = 45.0

    def __post_init__(self) -> None:
        for rules in (OverhangRules, SectionRules, TerritoryRules):
            rules.__post_init__(self)
        require_bounds(self, "strut_angle_deg", at_least=10, at_most=80)
