"""Turns connectors that fill their whole columns into teeth or points, with necks and windows."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.errors import JobError
from amprep.geometry.connector_sites import find_sites
from amprep.geometry.connector_tips import Profile, tips
from amprep.geometry.connector_windows import windows
from amprep.geometry.connectors import Columns
from amprep.model.arrays import Bools, Floats
from amprep.model.endings import Connector

if TYPE_CHECKING:
    from manifold3d import Manifold

WIDEST = 0.9
"""Share of their distance that teeth and points take at most where they meet the part."""

TOOTH_PITCH = 1.0
"""mm, about, between teeth where nothing else is said."""

_WHOLE = 1.0 - 1e-6


def shaped(
    connectors: "Manifold", contact: Floats, columns: Columns, base: Floats, wish: Connector, overlap: float
) -> "Manifold":
    """Return what is left of connectors that are to be of another kind; they still end in the true surface.

    Parameters
    ----------
    contact
        ``(t, 3, 3)`` mm, the parts' surface in the connectors.
    columns, base
        The red squares' columns, and where their connectors begin, ``(m,)`` mm.

    Raises
    ------
    JobError
        When the neck is no narrower than what it is to carry.
    """
    count, profile = _profile(wish, float(columns.grid[2]))
    depth = 0.0
    if profile is not None:
        sites = find_sites(contact, columns, count, profile.width)
        connectors ^= tips(sites, profile, base[sites.column], overlap)
        depth = profile.height
    if wish.window:
        for each in windows(columns, _room(contact, columns, depth), wish.window):
            connectors -= each
    return connectors


def _profile(wish: Connector, side: float) -> tuple[int, Profile | None]:
    """Return how many tips a square has each way, and their shape; None where the whole square runs up."""
    if wish.kind == "full" and wish.neck:
        # walls of 45 degrees above the neck, so that they can be printed
        width = min(WIDEST * side, wish.neck + 2.0 * wish.neck_height)
        return 1, _necked(Profile(width, 2.0 * wish.neck_height, wish.neck, wish.neck_height, False))
    if wish.kind not in ("teeth", "point"):
        return 1, None
    apart = wish.pitch or (TOOTH_PITCH if wish.kind == "teeth" else side)
    count = max(1, round(side / apart))
    width = min(wish.width, WIDEST * side / count)
    return count, _necked(Profile(width, wish.height, wish.neck, wish.neck_height, wish.kind == "point"))


def _necked(profile: Profile) -> Profile:
    if profile.neck >= profile.width:
        raise JobError(
            f"cells.neck_mm = {profile.neck:g} has to be below the width at the part, which is {profile.width:.3g} mm "
            "in this grid; set a smaller neck or a larger supports.pitch_mm"
        )
    return profile


def _room(contact: Floats, columns: Columns, depth: float) -> Floats:
    """Return the least height of the contact over each red square, less `depth`; 0 where it covers not all of it."""
    sites = find_sites(contact, columns, 1, 0.0)
    room = np.zeros(len(columns.lo))
    whole: Bools = sites.share >= _WHOLE
    own = sites.column[whole]
    room[own] = sites.lowest[whole] - columns.lo[own, 2] - depth
    return np.maximum(room, 0.0)
