"""Shape plain connectors into teeth or points, with break-away necks and perforation."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.errors import JobError
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.connectors.perforation import perforations
from amprep.geometry.connectors.sites import find_sites
from amprep.geometry.connectors.tips import TipProfile, grid_prisms, make_tips
from amprep.geometry.merging.union import union
from amprep.model.contacts import ConnectorRules
from amprep.model.supports.edges import square_keys
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold

WIDEST = 0.9
"""Largest width of teeth and points at the part, as a fraction of their pitch."""

TOOTH_PITCH = 1.0
"""Default distance (mm) between teeth; it is rounded so that a whole number fits the square."""

PAD = 0.2
"""Thickness (mm) of the plate below tips that begin below their red square (at most half of that depth)."""

SINK_UPRIGHT, SINK_SIDEWAYS = 0.75, 0.25
"""Largest depth at which connectors may begin below their red square, as a fraction of a step."""

_PAST = 0.01
"""Height (mm) by which notches extend above the red square."""

NUDGE = (1.3e-4, 2.1e-4, 0.9e-4)
"""Shift (mm) of all tips, so that none of their faces is coplanar with a face of the connectors.

On coplanar faces manifold3d leaves folds, and loses volume when it reads such a mesh again."""

_WIDER = 2e-3
"""Length (mm) by which notches are wider than squares: faces in the same plane as those of cells would leave foils."""

_MARGIN = 0.03
"""Length (mm) by which the narrowest tips are wider than the least section, because circles are polygons."""

_WHOLE = 1.0 - 1e-6


class TipSpacing(NamedTuple):
    """Distance of tips where the rules do not state their pitch.

    Attributes
    ----------
    distance
        Largest distance (mm) between neighbouring tips; 0 for the defaults of the connectors.
    close
        ``(m,)`` columns whose tips are at most half of that apart.
    """

    distance: float
    close: Bools

    def classes(self) -> list[tuple[Bools, float]]:
        """Return the columns with equal distances and the distance in them, mm."""
        if not self.distance or not self.close.any():
            return [(np.ones(len(self.close), np.bool_), self.distance)]
        both = ((~self.close, self.distance), (self.close, self.distance / 2))
        return [each for each in both if each[0].any()]


class ShapedConnectors(NamedTuple):
    """Shaped connectors, and the notch to subtract from the cells below so that tips have their full height."""

    connectors: "Manifold"
    notch: "Manifold"


def sink_depths(layout: SupportLayout, rules: ConnectorRules, *, most: float) -> Floats:
    """Return the depth below each red square at which its connector may begin, ``(m,)`` mm, for tips of full height.

    The depth is 0 on the plate and for connectors without tips. Where an oblique edge meets the red square it is at
    most a quarter of a step, so that connector and cell still overlap.

    Parameters
    ----------
    layout
        Red squares and edges.
    rules
        Shape of the connectors.
    most
        Upper bound on the depth, mm.
    """
    grid = layout.grid
    _, profile = _profile(rules, grid.pitch)
    if profile is None:
        return np.zeros(len(layout.red.square))
    oblique = layout.edges.direction != 0
    meets_oblique = np.isin(square_keys(layout.red.square), square_keys(layout.edges.upper[oblique]))
    fraction = np.where(meets_oblique, SINK_SIDEWAYS, SINK_UPRIGHT)
    return np.where(
        layout.red.square[:, 0] > 0, np.minimum(fraction * grid.step, min(profile.height + PAD, most)), 0.0
    )


def shape_connectors(
    connectors: "Manifold",
    contact: Floats,
    columns: ConnectorColumns,
    base: Floats,
    sink: Floats,
    rules: ConnectorRules,
    spacing: TipSpacing,
    overlap: float,
    on_solid: Bools,
    least: LeastSection | None = None,
) -> ShapedConnectors:
    """Intersect plain connectors with tips and perforate them; they still end in the true surface of the part.

    Parameters
    ----------
    connectors
        Plain connectors; they begin `sink` below their squares where that is lower than `base`.
    contact
        ``(t, 3, 3)`` mm, surface of the parts inside the connectors.
    columns
        Columns above the red squares.
    base, sink
        ``(m,)`` mm, height at which connectors begin that need no greater depth, and the depth below the square at
        which the others may begin.
    rules
        Shape of the connectors.
    spacing
        Distance of tips in each column.
    overlap
        Depth (mm) to which connectors enter the part.
    on_solid
        ``(m,)`` whether a cell fills the whole square below each connector. On other cells a connector that does not
        cover its square begins no deeper, because there could be nothing below it.
    least
        Least section of supports; None for none.

    Raises
    ------
    JobError
        When the neck is not narrower than the tip above it.
    """
    side, square = float(columns.grid[2]), columns.lo[:, 2]
    tip_height, lowest = 0.0, np.full(len(square), np.inf)
    pad = np.minimum(PAD, sink / 2.0)
    floor = square - sink + pad
    sunk = sink > 0.0
    tips = []
    for chosen, distance in spacing.classes():
        count, profile = _profile(rules, side, distance)
        if profile is None:
            break
        tip_height = profile.height
        narrow = None if least is None else least.diameter + _MARGIN
        sites = find_sites(contact, _columns_of(columns, chosen), count, profile.width, narrow)
        covered = np.bincount(sites.column[sites.whole], minlength=int(chosen.sum())) == count * count
        sunk[chosen] &= covered | on_solid[chosen]
        own = np.flatnonzero(chosen)[sites.column]
        level = np.maximum(sites.lowest - profile.height, np.where(sunk, floor, -np.inf)[own])
        np.minimum.at(lowest, own, level)
        base = np.where(sunk, np.minimum(base, lowest - pad), base)
        tips.append(make_tips(sites, profile, level, base[own], lowest[own], overlap))
    notch = union([])
    if tips:
        connectors ^= union(tips).translate(NUDGE)
        low = (lowest < square) & sunk
        plan = columns.square[low], columns.lo[low, :2] - _WIDER, columns.hi[low, :2] + _WIDER
        notch = grid_prisms(*plan, (lowest - pad / 2.0)[low], square[low] + _PAST)
    if rules.perforation_mm:
        solid = _solid_heights(contact, columns, tip_height)
        for opening in perforations(columns, solid, rules.perforation_mm):
            connectors -= opening
    return ShapedConnectors(connectors, notch)


def _columns_of(columns: ConnectorColumns, chosen: Bools) -> ConnectorColumns:
    return columns._replace(lo=columns.lo[chosen], hi=columns.hi[chosen], square=columns.square[chosen])


def _profile(rules: ConnectorRules, side: float, distance: float = 0.0) -> tuple[int, TipProfile | None]:
    """Return the number of tips along the side of a square and their profile; None for plain connectors.

    Where the rules do not state the pitch of the tips, these are at most `distance` mm apart, if that is not 0.
    """
    neck, neck_height = rules.neck_mm, rules.neck_height_mm
    if rules.connector == "full" and neck:
        # the flanks above the neck have 45 degrees, so that they can be printed
        width = min(WIDEST * side, neck + 2.0 * neck_height)
        return 1, _require_neck(TipProfile(width, 2.0 * neck_height, neck, neck_height, False))
    if not rules.has_tips:
        return 1, None
    is_round = rules.connector == "point"
    pitch = rules.tip_pitch_mm or (side if is_round else TOOTH_PITCH)
    count = max(1, round(side / pitch))
    if distance and not rules.tip_pitch_mm:
        count = max(1, int(np.ceil(side / distance - 1e-9)))
    width = min(rules.tip_width_mm, WIDEST * side / count)
    return count, _require_neck(TipProfile(width, rules.tip_height_mm, neck, neck_height, is_round))


def _require_neck(profile: TipProfile) -> TipProfile:
    if profile.neck >= profile.width:
        raise JobError(
            f"cells.neck_mm must be below the width at the part, {profile.width:.3g} mm in this grid, got "
            f"{profile.neck:g}; set a smaller neck or a larger supports.pitch_mm"
        )
    return profile


def _solid_heights(contact: Floats, columns: ConnectorColumns, tip_height: float) -> Floats:
    """Return the height above each red square up to which its connector fills the whole square, ``(m,)`` mm.

    That is the least height of the contact, less the height of the tips; 0 where contact covers only a part of the
    square.
    """
    sites = find_sites(contact, columns, 1, 0.0)
    height = np.zeros(len(columns.lo))
    whole: Bools = sites.fraction >= _WHOLE
    own = sites.column[whole]
    height[own] = sites.lowest[whole] - columns.lo[own, 2] - tip_height
    return np.maximum(height, 0.0)
