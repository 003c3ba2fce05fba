"""Rules for the two ends of supports: connectors at the part, bases on the build plate.

The job's section ``[cells]`` inherits from both records, so the names of the fields are the keys of the job file.
"""

from dataclasses import dataclass
from typing import Literal

from amprep.validation import require, require_bounds

ConnectorKind = Literal["full", "teeth", "point", "extend"]
BaseKind = Literal["direct", "flange", "raft"]

SMALLEST_DETAIL = 0.05
"""Smallest size (mm) of teeth, points, necks and perforations: no printer resolves smaller ones."""

LARGEST_BASE = 50.0
"""Largest margin and height (mm) of a flange or raft."""


@dataclass(frozen=True)
class ConnectorRules:
    """Shape of the connectors between red squares and the part.

    Attributes
    ----------
    connector
        ``full``: the connector fills the whole square; ``teeth``: it ends in a grid of square teeth; ``point``: it
        ends in cones; ``extend``: the lattice cell itself continues up to the part.
    tooth_pitch_mm, tooth_width_mm, tooth_height_mm
        Distance between teeth (None: at most the contact spacing, without one about 1 mm), their width
        at the part, and the length of their taper.
    point_pitch_mm, point_mm, point_height_mm
        Distance between points (None: at most the contact spacing, and one per square), their
        diameter at the part, and the length of their taper.
    neck_mm
        Width of the break-away neck below the contact; 0 for none.
    neck_height_mm
        Distance of the neck below the lowest point of the contact.
    perforation_mm
        Width of the diamond-shaped openings that perforate the connectors; 0 for none.
    """

    connector: ConnectorKind = "full"
    tooth_pitch_mm: float | None = None
    tooth_width_mm: float = 0.5
    tooth_height_mm: float = 0.8
    point_pitch_mm: float | None = None
    point_mm: float = 0.5
    point_height_mm: float = 1.0
    neck_mm: float = 0.0
    neck_height_mm: float = 0.3
    perforation_mm: float = 0.0

    def __post_init__(self) -> None:
        sizes = ("tooth_width_mm", "tooth_height_mm", "point_mm", "point_height_mm", "neck_height_mm")
        require_bounds(self, *sizes, at_least=SMALLEST_DETAIL)
        _require_none_or_detail(self, "neck_mm", "perforation_mm")
        for name, width in (("tooth_pitch_mm", self.tooth_width_mm), ("point_pitch_mm", self.point_mm)):
            pitch = getattr(self, name)
            require(pitch is None or pitch > width, f"{name} must be above the width of {width:g} mm", pitch)
        require(
            self.connector != "extend" or not (self.neck_mm or self.perforation_mm),
            "neck_mm and perforation_mm need connector = 'full', 'teeth' or 'point'",
            repr(self.connector),
        )
        if self.neck_mm and self.has_tips:
            width, height = self.tip_width_mm, self.tip_height_mm
            require(
                self.neck_mm < width, f"neck_mm must be below the tip width of {width:g} mm", self.neck_mm
            )
            require(
                self.neck_height_mm < height,
                f"neck_height_mm must be below the tip height of {height:g} mm",
                self.neck_height_mm,
            )

    @property
    def has_tips(self) -> bool:
        """Whether connectors end in teeth or points."""
        return self.connector in ("teeth", "point")

    @property
    def is_shaped(self) -> bool:
        """Whether connectors differ from plain columns over whole squares."""
        return self.has_tips or (self.connector == "full" and self.neck_mm + self.perforation_mm > 0)

    @property
    def tip_pitch_mm(self) -> float | None:
        """Distance between teeth or points; None for the default."""
        return self.point_pitch_mm if self.connector == "point" else self.tooth_pitch_mm

    @property
    def tip_width_mm(self) -> float:
        """Width of teeth, or diameter of points, at the part."""
        return self.point_mm if self.connector == "point" else self.tooth_width_mm

    @property
    def tip_height_mm(self) -> float:
        """Length over which teeth or points taper."""
        return self.point_height_mm if self.connector == "point" else self.tooth_height_mm


@dataclass(frozen=True)
class BaseRules:
    """Shape of the bases of supports on the build plate.

    Attributes
    ----------
    base
        ``direct``: no base; ``flange``: a widened base below every foot; ``raft``: one plate below all feet of a
        support.
    flange_mm, flange_height_mm
        Margin of flanges around the feet, and their height.
    raft_margin_mm, raft_height_mm
        Margin of rafts around the feet, and their height.
    raft_hole_mm
        Diameter of the holes in rafts; 0 for none.
    """

    base: BaseKind = "direct"
    flange_mm: float = 1.0
    flange_height_mm: float = 0.6
    raft_margin_mm: float = 2.0
    raft_height_mm: float = 0.6
    raft_hole_mm: float = 0.0

    def __post_init__(self) -> None:
        sizes = ("flange_mm", "flange_height_mm", "raft_margin_mm", "raft_height_mm")
        require_bounds(self, *sizes, at_least=SMALLEST_DETAIL, at_most=LARGEST_BASE)
        _require_none_or_detail(self, "raft_hole_mm")

    @property
    def base_margin_mm(self) -> float:
        """Margin of the base around the feet."""
        return self.raft_margin_mm if self.base == "raft" else self.flange_mm

    @property
    def base_height_mm(self) -> float:
        """Height of the base."""
        return self.raft_height_mm if self.base == "raft" else self.flange_height_mm


def _require_none_or_detail(record: object, *names: str) -> None:
    for name in names:
        value = getattr(record, name)
        rule = f"{name} must be 0 or at least {SMALLEST_DETAIL}"
        require(value == 0 or value >= SMALLEST_DETAIL, rule, value)
