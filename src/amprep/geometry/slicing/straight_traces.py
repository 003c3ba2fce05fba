"""Find long straight edges of the layers of a body: the lines in which layers cut its planar faces."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.slicing.planar_faces import PlanarFaces

# Strategy. All layers cut a planar face in parallel lines: the traces of its plane, horizontal and perpendicular to its
# normal. A trace is no longer than the face is wide in that direction, which leaves few faces. Between two neighbouring
# heights of vertices the length of each piece of the section is a linear function of the height, so that the longest
# trace is found just above or just below the height of a vertex.

_LEVEL = 0.02
"""Horizontal part of the unit normal from which a face counts as cut by layers; flatter ones have one or two layers."""

_JOINT = 1e-3
"""mm between neighbouring pieces of a section up to which they are one edge."""

_MOST_HEIGHTS = 64
"""Heights at which a face with many vertices is cut; more are thinned out."""


class Traces(NamedTuple):
    """The longest trace of each planar face that has a long one.

    Attributes
    ----------
    angle_deg
        ``(k,)`` direction in plan, counter-clockwise from x, 0 to 180 degrees.
    length
        ``(k,)`` mm.
    middle
        ``(k, 3)`` mm.
    low, high
        ``(k,)`` lowest and highest point of the face, mm.
    """

    angle_deg: Floats
    length: Floats
    middle: Floats
    low: Floats
    high: Floats


def straight_traces(
    faces: PlanarFaces,
    least: float,
    rotation: Floats | None = None,
    chosen: Callable[[Floats], Bools] | None = None,
) -> Traces:
    """Return the longest trace of each planar face that has one of at least the length `least` (mm).

    Parameters
    ----------
    faces
        Planar faces of a body.
    least
        Least length, mm.
    rotation
        ``(3, 3)`` by which the body is turned before it is cut; None for none.
    chosen
        Tells which directions (degrees) of traces are of interest; None for all.
    """
    turn = np.eye(3) if rotation is None else rotation
    points, normal = faces.points @ turn.T, faces.normal @ turn.T
    wide = np.hypot(normal[:, 0], normal[:, 1])
    along = np.column_stack([-normal[:, 1], normal[:, 0]]) / np.where(wide > _LEVEL, wide, 1.0)[:, None]
    angle = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 180.0
    wanted = (wide > _LEVEL) & (_widths(points, faces, along) >= least)
    if chosen is not None:
        wanted &= chosen(angle)
    order = np.argsort(faces.label, kind="stable")
    ends = np.searchsorted(faces.label[order], np.arange(len(wide) + 1))
    found = []
    for face in np.flatnonzero(wanted):
        corners = points[faces.triangles[order[ends[face] : ends[face + 1]]]]
        place = corners[:, :, :2] @ along[face]
        length, height, middle = _longest(np.stack([place, corners[:, :, 2]], axis=2))
        if length >= least:
            x, y = _point(normal[face], along[face], corners[0, 0], middle, height)
            found.append((angle[face], length, x, y, height, corners[:, :, 2].min(), corners[:, :, 2].max()))
    table = np.array(found, np.float64).reshape(-1, 7)
    return Traces(table[:, 0], table[:, 1], table[:, 2:5], table[:, 5], table[:, 6])


def _widths(points: Floats, faces: PlanarFaces, along: Floats) -> Floats:
    """Return the width (mm) of each face in the direction of its traces."""
    corners = points[faces.triangles][:, :, :2]
    place = np.einsum("ijk,ik->ij", corners, along[faces.label])
    low, high = np.full(len(along), np.inf), np.full(len(along), -np.inf)
    np.minimum.at(low, faces.label, place.min(axis=1))
    np.maximum.at(high, faces.label, place.max(axis=1))
    return np.asarray(high - low, np.float64)


def _longest(corners: Floats) -> tuple[float, float, float]:
    """Return length, height and middle of the longest section of triangles ``(m, 3, 2)``: place along it, height."""
    best = 0.0, 0.0, 0.0
    for height in _heights(corners[:, :, 1]).tolist():
        low, high = _sections(corners, height)
        for start, end in _joined(low, high):
            if end - start > best[0]:
                best = end - start, height, (start + end) / 2.0
    return best


def _heights(z: Floats) -> Floats:
    """Return heights just above and just below those of the vertices, within the face."""
    levels = np.unique(np.round(z, 6))
    gaps = np.diff(levels)
    close = np.minimum(1e-4, gaps / 4.0)
    heights = np.concatenate([levels[:-1] + close, levels[1:] - close])
    return heights[:: 1 + len(heights) // _MOST_HEIGHTS]


def _sections(corners: Floats, height: float) -> tuple[Floats, Floats]:
    """Return start and end of the section of each triangle that a height cuts; no vertex is at that height."""
    above: Bools = corners[:, :, 1] > height
    cut = corners[above.any(axis=1) & ~above.all(axis=1)]
    start, end = cut, np.roll(cut, -1, axis=1)
    rise = end[:, :, 1] - start[:, :, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (height - start[:, :, 1]) / rise
    crossed = (part >= 0.0) & (part <= 1.0) & (rise != 0.0)
    place = start[:, :, 0] + np.where(crossed, part, 0.0) * (end[:, :, 0] - start[:, :, 0])
    low = np.where(crossed, place, np.inf).min(axis=1)
    return low, np.where(crossed, place, -np.inf).max(axis=1)


def _joined(low: Floats, high: Floats) -> list[tuple[float, float]]:
    """Return the union of intervals."""
    order: Int64s = np.argsort(low)
    merged: list[tuple[float, float]] = []
    for start, end in zip(low[order].tolist(), high[order].tolist(), strict=True):
        if merged and start <= merged[-1][1] + _JOINT:
            merged[-1] = merged[-1][0], max(merged[-1][1], end)
        else:
            merged.append((start, end))
    return merged


def _point(normal: Floats, along: Floats, corner: Floats, place: float, height: float) -> tuple[float, float]:
    """Return x and y of the point of a plane at a height and at a place along its traces."""
    flat = normal[:2] / np.hypot(normal[0], normal[1])
    slope = normal[2] / np.hypot(normal[0], normal[1])
    across = float(corner[:2] @ flat) - slope * (height - float(corner[2]))
    x, y = (across * flat + place * along).tolist()
    return x, y
