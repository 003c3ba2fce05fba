"""Records of what differs between two builds."""

from dataclasses import dataclass
from typing import Any, Literal

Change = Literal["added", "removed", "moved", "turned", "other geometry"]


@dataclass(frozen=True)
class PartDifference:
    """A part that is in one build only, or elsewhere in the other one.

    Attributes
    ----------
    label
        Its name in the builds.
    change
        What happened to it from the first build to the second.
    moved_mm
        Largest distance that one of its points moved.
    turned_deg
        Angle of the rotation between both placements.
    """

    label: str
    change: Change
    moved_mm: float = 0.0
    turned_deg: float = 0.0


@dataclass(frozen=True)
class SupportDifference:
    """The supports of some parts, which differ.

    Attributes
    ----------
    parts
        Labels of the parts that they hold.
    before_mm3, after_mm3
        Volume in the first and in the second build; 0 where the build has none.
    """

    parts: tuple[str, ...]
    before_mm3: float
    after_mm3: float


@dataclass(frozen=True)
class SettingDifference:
    """A setting with different values: its name, as the record of the build has it, and both values."""

    name: str
    before: Any
    after: Any


@dataclass(frozen=True)
class ListedDifference:
    """Area of the listed overhangs of a part (mm2), and their number, in both builds."""

    part: str
    before_mm2: float
    after_mm2: float
    before: int
    after: int


@dataclass(frozen=True)
class BuildDifferences:
    """In what two builds differ; empty where they are equal."""

    parts: tuple[PartDifference, ...] = ()
    supports: tuple[SupportDifference, ...] = ()
    listed: tuple[ListedDifference, ...] = ()
    settings: tuple[SettingDifference, ...] = ()

    @property
    def none(self) -> bool:
        """Whether the builds are equal to the rounding of build files."""
        return not (self.parts or self.supports or self.listed or self.settings)
