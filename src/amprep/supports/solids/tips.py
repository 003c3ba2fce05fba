"""Turns connectors that fill their whole columns into teeth or points, with necks and windows."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.errors import JobError
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.perforation import windows
from amprep.geometry.connectors.sites import find_sites
from amprep.geometry.connectors.tips import TipProfile, prisms, tips
from amprep.geometry.merging.union import union
from amprep.model.contacts import Connector
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold

WIDEST = 0.9
"""Share of their distance that teeth and points take at most where they meet the part."""

TOOTH_PITCH = 1.0
"""mm, about, between teeth where nothing else is said."""

PAD = 0.2
"""mm; thickness of what carries tips where they begin below their red square (at most half of that depth)."""

SINK_UPRIGHT, SINK_SIDEWAYS = 0.75, 0.25
"""Share of a step that connectors may begin below their red square at most."""

_PAST = 0.01
"""mm that notches reach above the red square."""

NUDGE = (1.3e-4, 2.1e-4, 0.9e-4)
"""mm; tips are moved by that, so that none of their faces lies in one of the connectors they are cut out of:
manifold3d leaves folds there, and loses volume when it reads them again."""

_WHOLE = 1.0 - 1e-6


class ShapedConnectors(NamedTuple):
    """Connectors of another kind, and what has to go from the cells below so that tips have room."""

    connectors: "Manifold"
    notch: "Manifold"


def sink_depths(layout: SupportLayout, wish: Connector, *, most: float) -> Floats:
    """Return how far connectors may reach below each red square, ``(m,)`` mm, so that tips have their height.

    At most `most` mm, and as far as they ask for where all cells below are upright; a quarter of a step where one
    leads sideways, which they still meet then. Nothing on the plate, nor where the whole square runs up.
    """
    frame = layout.frame
    _, profile = _profile(wish, frame.pitch)
    if profile is None:
        return np.zeros(len(layout.red))
    leaning = layout.edges.direction != 0
    _, ny, nx = frame.shape

    def place(plane: Ints, y: Ints, x: Ints) -> Ints:
        return np.asarray((plane.astype(np.int64) * ny + y) * nx + x)

    sideways = place(*layout.edges.upper[leaning].T)
    share = np.where(np.isin(place(*layout.red.T), sideways), SINK_SIDEWAYS, SINK_UPRIGHT)
    return np.where(
        layout.red[:, 0] > 0, np.minimum(share * frame.step, min(profile.height + PAD, most)), 0.0
    )


def shape_connectors(
    connectors: "Manifold",
    contact: Floats,
    columns: ConnectorColumns,
    base: Floats,
    sink: Floats,
    wish: Connector,
    overlap: float,
) -> ShapedConnectors:
    """Return what is left of connectors that are to be of another kind; they still end in the true surface.

    Parameters
    ----------
    connectors
        They begin at `sink` below their squares, where that is lower than `base`.
    contact
        ``(t, 3, 3)`` mm, the parts' surface in the connectors.
    columns, base, sink
        The red squares' columns; where connectors begin that need no more room, and how far below the square
        others may, ``(m,)`` mm.

    Raises
    ------
    JobError
        When the neck is no narrower than what it is to carry.
    """
    count, profile = _profile(wish, float(columns.grid[2]))
    depth, notch = 0.0, union([])
    if profile is not None:
        sites = find_sites(contact, columns, count, profile.width)
        own, square = sites.column, columns.lo[:, 2]
        pad = np.minimum(PAD, sink / 2.0)
        floor = np.where(sink > 0.0, square - sink + pad, -np.inf)
        level = np.maximum(sites.lowest - profile.height, floor[own])
        lowest = np.full(len(square), np.inf)
        np.minimum.at(lowest, own, level)
        base = np.where(sink > 0.0, np.minimum(base, lowest - pad), base)
        connectors ^= tips(sites, profile, level, base[own], overlap).translate(NUDGE)
        low = (lowest < square) & (sink > 0.0)
        plan = columns.square[low], columns.lo[low, :2], columns.hi[low, :2]
        notch = prisms(*plan, (lowest - pad / 2.0)[low], square[low] + _PAST)
        depth = profile.height
    if wish.window:
        for each in windows(columns, _room(contact, columns, depth), wish.window):
            connectors -= each
    return ShapedConnectors(connectors, notch)


def _profile(wish: Connector, side: float) -> tuple[int, TipProfile | None]:
    """Return how many tips a square has each way, and their shape; None where the whole square runs up."""
    if wish.kind == "full" and wish.neck:
        # walls of 45 degrees above the neck, so that they can be printed
        width = min(WIDEST * side, wish.neck + 2.0 * wish.neck_height)
        return 1, _necked(TipProfile(width, 2.0 * wish.neck_height, wish.neck, wish.neck_height, False))
    if wish.kind not in ("teeth", "point"):
        return 1, None
    apart = wish.pitch or (TOOTH_PITCH if wish.kind == "teeth" else side)
    count = max(1, round(side / apart))
    width = min(wish.width, WIDEST * side / count)
    return count, _necked(TipProfile(width, wish.height, wish.neck, wish.neck_height, wish.kind == "point"))


def _necked(profile: TipProfile) -> TipProfile:
    if profile.neck >= profile.width:
        raise JobError(
            f"cells.neck_mm = {profile.neck:g} has to be below the width at the part, which is {profile.width:.3g} mm "
            "in this grid; set a smaller neck or a larger supports.pitch_mm"
        )
    return profile


def _room(contact: Floats, columns: ConnectorColumns, depth: float) -> Floats:
    """Return the least height of the contact over each red square, less `depth`; 0 where it covers not all of it."""
    sites = find_sites(contact, columns, 1, 0.0)
    room = np.zeros(len(columns.lo))
    whole: Bools = sites.share >= _WHOLE
    own = sites.column[whole]
    room[own] = sites.lowest[whole] - columns.lo[own, 2] - depth
    return np.maximum(room, 0.0)
