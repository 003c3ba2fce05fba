"""Raise walls without thickness from red squares to the overhangs above them."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.connect import find_covered
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import merge_vertices
from amprep.kernels.meshes.patches import Patches

_SHORTEST = 1e-4
"""Length (mm) in plan below which pieces of a wall are left out."""


def raise_sheets(
    columns: ConnectorColumns,
    column: Int64s,
    segments: Floats,
    supported: Patches,
    surface: Patches,
    *,
    overlap: float,
) -> MeshArrays:
    """Return vertical walls over segments in plan, from the red square up to the supported faces and into them.

    Parameters
    ----------
    columns
        All columns.
    column, segments
        ``(k,)`` column of each segment, and ``(k, 2, 2)`` its ends in plan, mm.
    supported, surface, overlap
        As for `amprep.geometry.connectors.connect.connect`.
    """
    covered = find_covered(supported, surface)[column]
    pieces = [_pieces(segments, column, supported, np.flatnonzero(~covered))]
    wanted = _pieces(segments, column, supported, np.flatnonzero(covered))
    blocking = _pieces(segments, column, surface, np.flatnonzero(covered))
    for index in np.flatnonzero(covered):
        pieces.append(_lowest(wanted[wanted[:, 0] == index], blocking[blocking[:, 0] == index]))
    return _sheets(np.concatenate(pieces), columns.lo[column, 2], segments, overlap)


def _pieces(segments: Floats, column: Int64s, patches: Patches, chosen: Int64s) -> Floats:
    """Clip segments to the outlines of the patches in their columns (Cyrus and Beck 1978).

    Returns
    -------
    pieces
        ``(n, 5)`` segment, parameters (0 to 1) at which the piece begins and ends, and heights of the patch there, mm.
    """
    counts = np.diff(patches.of_column)[column[chosen]]
    segment = np.repeat(chosen, counts)
    within = np.arange(len(segment)) - np.repeat(np.cumsum(counts) - counts, counts)
    patch = np.repeat(patches.of_column[column[chosen]], counts) + within
    first, sizes = patches.start[patch], np.diff(patches.start)[patch]
    start, along = segments[segment, 0], segments[segment, 1] - segments[segment, 0]
    enter, leave = np.zeros(len(segment)), np.ones(len(segment))
    normal = np.zeros((len(segment), 3))
    for corner in range(int(sizes.max(initial=0))):
        has = corner < sizes
        here = patches.points[first + np.where(has, corner, 0)]
        following = patches.points[first + np.where(corner + 1 < sizes, corner + 1, 0)]
        normal += np.where(
            has[:, None], np.cross(here - patches.points[first], following - patches.points[first]), 0.0
        )
        side = following - here
        inward = np.column_stack([-side[:, 1], side[:, 0]])
        distance = np.einsum("ij,ij->i", start - here[:, :2], inward)
        speed = np.einsum("ij,ij->i", along, inward)
        crossing = np.divide(-distance, speed, out=np.zeros_like(speed), where=np.abs(speed) > 1e-12)
        enter = np.where(has & (speed > 1e-12), np.maximum(enter, crossing), enter)
        leave = np.where(has & (speed < -1e-12), np.minimum(leave, crossing), leave)
        leave = np.where(has & (np.abs(speed) <= 1e-12) & (distance < 0.0), -1.0, leave)
    pieces = np.column_stack([segment, enter, leave, enter, leave])
    for height, place in ((3, 1), (4, 2)):
        point = start + along * pieces[:, place : place + 1] - patches.points[first, :2]
        pieces[:, height] = (
            patches.points[first, 2] - np.einsum("ij,ij->i", point, normal[:, :2]) / normal[:, 2]
        )
    length = np.linalg.norm(along, axis=1)
    return np.asarray(pieces[(leave - enter) * length > _SHORTEST])


def _lowest(wanted: Floats, blocking: Floats) -> Floats:
    """Return the parts of the wanted pieces of one segment that nothing is below."""
    bounds = np.unique(np.concatenate([wanted[:, 1:3].ravel(), blocking[:, 1:3].ravel()]))
    found = []
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        middle = (begin + end) / 2
        heights = _heights(wanted, middle)
        if not len(heights) or heights.min() > _heights(blocking, middle).min(initial=np.inf) + 1e-6:
            continue
        lowest = wanted[heights.argmin()]
        ends = [_height_at(lowest, begin), _height_at(lowest, end)]
        found.append([lowest[0], begin, end, *ends])
    return np.array(found).reshape(-1, 5)


def _heights(pieces: Floats, place: float) -> Floats:
    """Return the heights of pieces at a parameter of the segment, infinity for pieces that do not contain it."""
    reaches = (pieces[:, 1] <= place) & (place <= pieces[:, 2])
    heights = np.array([_height_at(piece, place) for piece in pieces])
    return np.where(reaches, heights, np.inf) if len(pieces) else heights


def _height_at(piece: Floats, place: float) -> float:
    fraction = (place - piece[1]) / (piece[2] - piece[1])
    return float(piece[3] + fraction * (piece[4] - piece[3]))


def _sheets(pieces: Floats, base: Floats, segments: Floats, overlap: float) -> MeshArrays:
    """Return the walls below pieces, two triangles each."""
    index = pieces[:, 0].astype(np.int64)
    start, along = segments[index, 0], segments[index, 1] - segments[index, 0]
    corners = []
    for place, height in ((1, None), (2, None), (2, 4), (1, 3)):
        plan = start + along * pieces[:, place : place + 1]
        level = base[index] if height is None else pieces[:, height] + overlap
        corners.append(np.column_stack([plan, level]))
    points = np.stack(corners, axis=1).reshape(-1, 3)
    quads = np.arange(len(points)).reshape(-1, 4)
    return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def plan_segments(points: Floats, triangles: Int64s) -> Floats:
    """Return the edges of a template in the bottom of the unit cube, in plan, ``(k, 2, 2)``."""
    level = np.abs(points[:, 2]) < 1e-9
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides = np.unique(np.sort(sides[level[sides].all(axis=1)], axis=1), axis=0)
    return np.asarray(points[sides][:, :, :2])


def join_sheets(sheets: Sequence[MeshArrays]) -> MeshArrays:
    """Join walls: merge equal vertices, drop degenerate triangles, and keep one of equal triangles."""
    counts = np.cumsum([0] + [len(points) for points, _ in sheets])
    points = np.vstack([points for points, _ in sheets])
    triangles = np.vstack([each + first for (_, each), first in zip(sheets, counts[:-1], strict=True)])
    points, triangles = merge_vertices(points, triangles)
    flat = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    triangles = triangles[~flat]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    return drop_unused_vertices(points, triangles[np.sort(first)])
