"""Conditions on overhang regions, by which the ``[[rule]]`` entries of a job choose them."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import PurePath
from typing import ClassVar

import numpy as np

from amprep.geometry.overhangs.regions import NOT_FACES, Kind, OverhangRegion
from amprep.model.part import Part
from amprep.validation import require

Range = tuple[float, ...]
"""The least and the greatest value; the least value alone has no upper end."""

_COLOUR = re.compile(r"#[0-9a-f]{6}", re.IGNORECASE)


@dataclass(frozen=True)
class RegionConditions:
    """Conditions that an overhang region must meet, all of them; None is met by every region.

    Attributes
    ----------
    kind
        Kind of the overhang, or several kinds.
    angle
        Range of the smallest angle of its faces to the plate, degrees.
    size
        Range of its size, mm: length of a ledge, span of a bridge, diameter of a bore.
    area
        Range of the area of its faces, mm2; edges and tips have the area 0.
    height
        Range of the height of its lowest point above the plate, mm.
    part
        Name of the part or of its file; ``*`` and ``?`` stand for any letters and any one letter.
    colour
        Colour that its faces are painted in, ``#RRGGBB``, or the name of a marked region of the part that they are in.
    """

    EXPECTED: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("angle", "size", "area", "height"), "[least, greatest] or [least]"
    )
    """What ranges look like, for messages."""

    kind: Kind | tuple[Kind, ...] | None = None
    angle: Range | None = None
    size: Range | None = None
    area: Range | None = None
    height: Range | None = None
    part: str | None = None
    colour: str | None = None

    def __post_init__(self) -> None:
        require(self.kind != (), "kind must name at least one kind of overhangs", "none")
        for name in ("angle", "size", "area", "height"):
            limits = getattr(self, name)
            fits = limits is None or (len(limits) in (1, 2) and 0.0 <= limits[0] <= limits[-1])
            require(fits, f"{name} must be [least, greatest] or [least], at least 0", limits and list(limits))
        require(self.part != "", "part must name a part", "an empty text")
        valid = self.colour is None or (self.colour and (self.colour[0] != "#" or self.paint))
        require(bool(valid), "colour must be '#RRGGBB' or the name of a region", repr(self.colour))

    @property
    def paint(self) -> str | None:
        """The colour as ``#rrggbb``; None for the name of a region and without a colour."""
        return self.colour.lower() if self.colour and _COLOUR.fullmatch(self.colour) else None

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds that are named."""
        return (self.kind,) if isinstance(self.kind, str) else self.kind or ()

    def are_met(self, region: OverhangRegion, part: Part, paint: Collection[str]) -> bool:
        """Tell whether a region of a part meets all conditions.

        Parameters
        ----------
        region
            The overhang region.
        part
            The part that it belongs to.
        paint
            Colours of the region as ``#rrggbb``, and the names of the marked regions that it is in.
        """
        area = 0.0 if region.kind in NOT_FACES else region.measure
        measured = (
            (self.angle, region.angle_deg),
            (self.size, region.size_mm),
            (self.area, area),
            (self.height, region.lowest_mm),
        )
        return (
            (self.kind is None or region.kind in self.kinds)
            and all(_is_within(value, limits) for limits, value in measured)
            and (self.part is None or is_named(part, self.part))
            and (self.colour is None or (self.paint or self.colour) in paint)
        )


def _is_within(value: float, limits: Range | None) -> bool:
    return limits is None or (limits[0] <= value and (len(limits) == 1 or value <= limits[1]))


def is_named(part: Part, pattern: str) -> bool:
    """Tell whether a pattern with ``*`` and ``?`` names the part, its file, or its file without the suffix."""
    file = PurePath(part.source)
    return any(fnmatchcase(name, pattern) for name in (part.name, file.name, file.stem) if name)


def colours_of(part: Part) -> frozenset[str]:
    """Return the colours of a part and of its triangles as ``#rrggbb``, and the names of its marked regions."""
    look = part.appearance
    corners = np.asarray([] if look.triangle_colours is None else look.triangle_colours, np.int64)
    own = np.unique(corners.reshape(-1, 3)[:, 0])
    painted = {f"#{value >> 8:06x}" for value in own.tolist() if value >= 0}
    whole = {look.colour[:7].lower()} if look.colour else set()
    return frozenset(painted | whole | {region.name for region in part.regions if region.name})
