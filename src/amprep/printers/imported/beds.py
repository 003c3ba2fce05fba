"""Turn the outline of a bed into a box or a cylinder with forbidden zones.

Strategy: an outline that fills its bounding box is a box, and one whose corners lie on a circle is a cylinder. Any
other is its bounding box, with zones over what is outside. The outline is cut into strips along y between its corners,
thin ones where edges are oblique. In a strip it consists of intervals of x: those that lie inside over the whole strip
are free. Zones of areas on the bed are found in the same way; there, what lies inside anywhere in a strip is forbidden.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError, JobError
from amprep.printers.catalogue import PrinterProfile
from amprep.typed import make

Zone = tuple[float, float, float, float, float, float]

_MOST_CORNERS = 10_000
"""Largest number of corners of an outline."""

_MOST_AREA_CORNERS = 1000
"""Largest number of corners of an area on the bed."""

_STRIPS = 32
"""Number of strips over the depth of a bed with oblique edges."""

_AREA_STRIPS = 8
"""Number of strips over the depth of an area on the bed with oblique edges: many zones make packing slow."""

_ROUND = 0.002
"""Relative deviation of the distances from the centre up to which an outline of many corners is a circle."""

_LEAST_CORNERS = 12
"""An outline of fewer corners is no circle."""

_LEAST = 1e-3
"""Shortest side (mm) of a zone."""


def profile_of_bed(
    name: str, outline: Floats, height: float, source: str, areas: Sequence[Floats] = ()
) -> PrinterProfile:
    """Return the profile of a filament printer with a bed.

    Parameters
    ----------
    name
        Name of the printer.
    outline
        ``(n, 2)`` corners of the bed in the machine's coordinates, mm, in either direction.
    height
        Height of the build volume, mm.
    source
        Where the figures come from.
    areas
        Outlines ``(k, 2)`` of areas on the bed that stay free, mm.

    Raises
    ------
    InputError
        If the outline has no area, or the sizes are no sizes of a printer.
    """
    if not 3 <= len(outline) <= _MOST_CORNERS or not np.isfinite(outline).all():
        raise InputError(f"{name}: expected an outline of the bed of 3 to {_MOST_CORNERS} finite corners")
    if any(len(area) > _MOST_AREA_CORNERS or not np.isfinite(area).all() for area in areas):
        raise InputError(f"{name}: expected areas of at most {_MOST_AREA_CORNERS} finite corners")
    low, high = outline.min(axis=0), outline.max(axis=0)
    width, depth = (high - low).tolist()
    forbidden = [
        zone for area in areas for zone in _zones(_strips(area - low, _AREA_STRIPS), (width, depth), height)
    ]
    if _is_circle(outline):
        diameter = 2.0 * float(np.linalg.norm(outline - (low + high) / 2.0, axis=1).mean())
        low = (low + high) / 2.0 - diameter / 2.0
        forbidden = [zone for zone in forbidden if _meets_circle(zone, diameter / 2.0)]
        shape, size = "cylinder", [diameter, height]
    else:
        shape, size = "box", [width, depth, height]
        if _area(outline) < (1.0 - 1e-6) * width * depth:
            forbidden += _outside(outline - low, (width, depth), height)
    keys = {
        "size_mm": _rounded(size),
        "name": name,
        "technology": "filament",
        "shape": shape,
        "zones": [_rounded(zone) for zone in forbidden],
        "origin_mm": _rounded(low.tolist()),
        "source": source,
    }
    try:
        return make(PrinterProfile, keys, name)
    except JobError as error:
        raise InputError(str(error)) from error


def _rounded(values: Sequence[float]) -> list[float]:
    return [round(value, 4) + 0.0 for value in values]


def _area(outline: Floats) -> float:
    x, y = outline.T
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2.0


def _is_circle(outline: Floats) -> bool:
    """Tell whether many corners lie on a circle around the middle, with no great gap between neighbours."""
    if len(outline) < _LEAST_CORNERS:
        return False
    centre = (outline.min(axis=0) + outline.max(axis=0)) / 2.0
    radius = np.linalg.norm(outline - centre, axis=1)
    side = np.linalg.norm(outline - np.roll(outline, -1, axis=0), axis=1)
    mean = float(radius.mean())
    return bool(np.ptp(radius) <= 2.0 * _ROUND * mean and side.max() <= 0.6 * mean)


def _meets_circle(zone: Zone, radius: float) -> bool:
    """Tell whether a zone meets the circle that its plate encloses."""
    x, y = (max(low, min(radius, high)) - radius for low, high in (zone[0::3][:2], zone[1::3][:2]))
    return x * x + y * y < radius * radius


Intervals = list[tuple[float, float]]
Strip = tuple[float, float, Intervals, Intervals]
"""Its y from and to, the intervals of x that are inside everywhere in it, and those that are inside anywhere."""


def _strips(outline: Floats, number: int) -> list[Strip]:
    """Cut an outline ``(n, 2)`` into strips along y; `number` of them, and more at corners, where it is oblique."""
    ends = np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)
    cuts = np.unique(outline[:, 1])
    oblique = (np.abs(ends[:, 0] - ends[:, 1]) > _LEAST).all(axis=1)
    if oblique.any():
        cuts = np.unique(np.concatenate([cuts, np.linspace(cuts[0], cuts[-1], number + 1)]))
    found: list[Strip] = []
    for low, high in pairwise(cuts.tolist()):
        if high - low < _LEAST / 10.0:
            continue
        crossing = (ends[:, :, 1].min(axis=1) <= low) & (ends[:, :, 1].max(axis=1) >= high)
        sides = sorted(_x_of(edge, low, high) for edge in ends[crossing].tolist())
        pairs = list(zip(sides[::2], sides[1::2], strict=False))
        inner = [(max(left[1:]), min(right[1:])) for left, right in pairs]
        outer = [(min(left[1:]), max(right[1:])) for left, right in pairs]
        found.append((low, high, [each for each in inner if each[1] > each[0]], outer))
    return found


def _x_of(edge: list[list[float]], low: float, high: float) -> tuple[float, float, float]:
    """Return the x of an edge in the middle of a strip, and at its lower and upper ends."""
    (x0, y0), (x1, y1) = edge
    at = [x0 + (x1 - x0) * (y - y0) / (y1 - y0) for y in (low, high)]
    return ((at[0] + at[1]) / 2.0, at[0], at[1])


def _outside(outline: Floats, size: tuple[float, float], height: float) -> list[Zone]:
    """Return zones that cover what is outside an outline within its bounding box."""
    strips: list[Strip] = []
    for low, high, inside, _ in _strips(outline, _STRIPS):
        borders = [0.0, *(border for interval in inside for border in interval), size[0]]
        outside = list(zip(borders[::2], borders[1::2], strict=True))
        strips.append((low, high, [], outside))
    return _zones(strips, size, height)


def _zones(strips: Sequence[Strip], size: tuple[float, float], height: float) -> list[Zone]:
    """Return boxes over the outer intervals of strips, within the plate; equal neighbours are one."""
    open_zones: dict[tuple[float, float], float] = {}
    found: list[Zone] = []
    previous = -np.inf
    for low, high, _, intervals in [*strips, (np.inf, np.inf, [], [])]:
        going_on = intervals if low == previous else []
        for interval in [each for each in open_zones if each not in going_on]:
            found.append((interval[0], open_zones.pop(interval), 0.0, interval[1], previous, height))
        for interval in intervals:
            open_zones.setdefault(interval, low)
        previous = high
    clipped = [
        (max(x0, 0.0), max(y0, 0.0), z0, min(x1, size[0]), min(y1, size[1]), z1)
        for x0, y0, z0, x1, y1, z1 in found
    ]
    return [zone for zone in clipped if zone[3] - zone[0] > _LEAST and zone[4] - zone[1] > _LEAST]
