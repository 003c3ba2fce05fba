"""Rotate boxes, measure their union, and find a position for them in an empty build volume."""

import itertools
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats


class Space(NamedTuple):
    """An empty build volume with the clearance taken off its walls.

    Attributes
    ----------
    lo, hi
        ``(3,)`` lower and upper corner of the region that boxes may use (mm).
    axis, radius
        ``(2,)`` centre and radius (mm) of the circle that contains every corner of a box; radius 0: no circle.
    zone_lo, zone_hi
        ``(m, 3)`` corners of the forbidden zones (mm); boxes may touch them.
    flat
        True if the lowest point of an item must be at `lo[2]`.
    slack
        Depth to which a box may enter a wall or a zone (mm).
    """

    lo: Floats
    hi: Floats
    axis: Floats
    radius: float
    zone_lo: Floats
    zone_hi: Floats
    flat: bool
    slack: float


def rotated_boxes(lo: Floats, hi: Floats, rotation: Floats) -> tuple[Floats, Floats]:
    """Return the corners ``(k, 3)`` of the axis-parallel boxes that enclose boxes rotated by a ``(3, 3)`` matrix."""
    centre, half = (lo + hi) / 2.0, (hi - lo) / 2.0
    centre, half = centre @ rotation.T, half @ np.abs(rotation).T
    return centre - half, centre + half


def union_volume(lo: Floats, hi: Floats) -> float:
    """Return the volume (or area) of the union of boxes ``(k, d)``; a box with a side of at most 0 is ignored.

    The boxes cut space into cells along the planes of their faces; the volumes of the covered cells are added.
    """
    real = (hi > lo).all(axis=1)
    lo, hi = lo[real], hi[real]
    if len(lo) <= 1:
        return float(np.prod(hi - lo, axis=1).sum())
    lines = [np.unique(np.concatenate((lo[:, a], hi[:, a]))) for a in range(lo.shape[1])]
    covered = np.zeros([len(line) - 1 for line in lines], dtype=bool)
    for corner, far in zip(lo, hi, strict=True):
        cells = (np.searchsorted(line, [a, b]) for line, a, b in zip(lines, corner, far, strict=True))
        covered[tuple(slice(*cell) for cell in cells)] = True
    for line in reversed(lines):
        covered = covered @ np.diff(line)
    return float(covered)


def find_feasible_position(lo: Floats, hi: Floats, space: Space) -> Floats | None:
    """Return a translation ``(3,)`` that places boxes ``(k, 3)`` in an empty build; None if there is none.

    The search is exact. The allowed translations at one height are bounded by lines (walls and sides of zones)
    and by circles (one per corner of the footprint). If any translation is allowed, one of the crossings of
    these curves is. The lowest heights are tried first.

    Parameters
    ----------
    lo, hi
        ``(k, 3)`` corners of the item's boxes (mm).
    space
        The empty build volume.
    """
    least, most = lo.min(axis=0), hi.max(axis=0)
    if ((most - least) > (space.hi - space.lo) + space.slack).any():
        return None
    if space.radius == 0.0 and not len(space.zone_lo):
        return np.asarray(space.lo - least)
    heights = [space.lo[2] - least[2]]
    if not space.flat:
        tops = (space.zone_hi[:, 2, None] - lo[:, 2]).ravel()
        heights += sorted(tops[tops > heights[0]].tolist())
    sources = [_simple_positions, _line_crossings, *([_circle_crossings] if space.radius else [])]
    for positions, height in itertools.product(sources, heights):
        found = _first_allowed(positions(lo, hi, space), height, lo, hi, space)
        if found is not None:
            return found
    return None


def _simple_positions(lo: Floats, hi: Floats, space: Space) -> Floats:
    """Return the translation ``(1, 2)`` to the lower corner of a box-shaped build, or to the centre of a round one."""
    least, most = lo.min(axis=0)[:2], hi.max(axis=0)[:2]
    return np.asarray(space.axis - (least + most) / 2.0 if space.radius else space.lo[:2] - least)[None]


def _lines(lo: Floats, hi: Floats, space: Space, axis: int) -> Floats:
    """Return the translations along an axis at which a box touches the lower wall or a side of a zone."""
    beyond = (space.zone_hi[:, axis, None] - lo[:, axis]).ravel()
    before = (space.zone_lo[:, axis, None] - hi[:, axis]).ravel()
    return np.unique(np.concatenate(([space.lo[axis] - lo[:, axis].min()], beyond, before)))


def _line_crossings(lo: Floats, hi: Floats, space: Space) -> Floats:
    """Return the crossings of the lines of both axes as translations ``(n, 2)``."""
    crossings = np.meshgrid(_lines(lo, hi, space, 0), _lines(lo, hi, space, 1), indexing="ij")
    return np.stack(crossings, axis=-1).reshape(-1, 2)


def _centres(lo: Floats, hi: Floats, space: Space) -> Floats:
    """Return for each corner of the footprint the centre of the disc of translations that keep it inside."""
    corners = [np.stack((a[:, 0], b[:, 1]), axis=1) for a, b in itertools.product((lo, hi), (lo, hi))]
    return np.asarray(space.axis - np.unique(np.concatenate(corners), axis=0))


def _circle_crossings(lo: Floats, hi: Floats, space: Space) -> Floats:
    """Return the crossings of the circles with each other and with the lines, and their extreme points."""
    centres, radius = _centres(lo, hi, space), space.radius
    extremes = [centres + radius * np.array(direction) for direction in ((-1, 0), (1, 0), (0, -1), (0, 1))]
    found = [*extremes, *_circle_pairs(centres, radius)]
    for axis in (0, 1):
        line = _lines(lo, hi, space, axis)
        offset = line[:, None] - centres[None, :, axis]
        half = np.sqrt(np.maximum(radius**2 - offset**2, 0.0))
        for sign in (-1, 1):
            other = centres[None, :, 1 - axis] + sign * half
            pair = (np.broadcast_to(line[:, None], other.shape), other)
            found.append(np.stack(pair if axis == 0 else pair[::-1], axis=-1).reshape(-1, 2))
    return np.concatenate(found)


def _circle_pairs(centres: Floats, radius: float) -> list[Floats]:
    """Return the two crossings of each pair of circles of equal radius, as two arrays ``(pairs, 2)``."""
    first, second = np.triu_indices(len(centres), 1)
    middle, apart = (centres[first] + centres[second]) / 2.0, centres[second] - centres[first]
    distance = np.hypot(apart[:, 0], apart[:, 1])
    reach = np.sqrt(np.maximum(radius**2 - distance**2 / 4.0, 0.0))
    across = np.stack((-apart[:, 1], apart[:, 0]), axis=1) * (reach / distance)[:, None]
    return [middle + across, middle - across]


def _first_allowed(positions: Floats, height: float, lo: Floats, hi: Floats, space: Space) -> Floats | None:
    """Return the first translation (a position ``(n, 2)`` and the height) inside the walls and outside the zones."""
    allowed = (positions >= space.lo[:2] - lo.min(axis=0)[:2] - space.slack).all(axis=1)
    allowed &= (positions <= space.hi[:2] - hi.max(axis=0)[:2] + space.slack).all(axis=1)
    allowed &= height <= space.hi[2] - hi[:, 2].max() + space.slack
    if space.radius:
        away = positions[:, None] - _centres(lo, hi, space)[None]
        allowed &= (np.hypot(away[..., 0], away[..., 1]) <= space.radius + space.slack / 2.0).all(axis=1)
    positions = positions[allowed]
    moved = np.column_stack((positions, np.full(len(positions), height)))
    for (corner, far), zone in itertools.product(
        zip(lo, hi, strict=True), zip(space.zone_lo, space.zone_hi, strict=True)
    ):
        clear = (moved + far <= zone[0] + space.slack) | (moved + corner >= zone[1] - space.slack)
        moved = moved[clear.any(axis=1)]
    return moved[0] if len(moved) else None
