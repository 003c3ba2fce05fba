"""Contacts of a layout: for each pair of near convex pieces a plane that separates them."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.bounding.gjk import pair_distance
from amprep.kernels.guided_search import EVERYWHERE
from amprep.kernels.helper import helper
from amprep.kernels.no_fit.records import ContactShapes, ShapeLayout

# Strategy. A plane separates two convex pieces if they are on different sides of it; the gap is their distance along
# its normal, less the clearance, and negative where they overlap or are too near. The normals that matter are those of
# faces of one of the pieces, and normals of an edge of each (the faces of the Minkowski sum); the plane of greatest gap
# is taken. It lets the pieces slide along a face. Where all of these gaps are negative, the normal from nearest point
# to nearest point (GJK) is tried as well, whose gap is the exact distance less the clearance. So two pieces that are
# not nearer than the clearance always have a plane with a gap of at least 0. Boxes of shapes and of pieces that are
# too far apart are skipped first, then pairs for which any plane shows a gap beyond the reach.

WORK = (8, 5)
"""Shape of the work array of `find_contacts`: a plane with its gap, a pose, and the simplex of GJK."""


@helper
def _boxes_apart(shapes, one, other, shift, limit):
    """Tell whether the boxes of pieces, the first one moved, are farther apart than a limit."""
    centre, half = shapes.corners.centre, shapes.corners.half
    return (
        abs(centre[one, 0] + shift[0] - centre[other, 0]) - half[one, 0] - half[other, 0] > limit
        or abs(centre[one, 1] + shift[1] - centre[other, 1]) - half[one, 1] - half[other, 1] > limit
        or abs(centre[one, 2] + shift[2] - centre[other, 2]) - half[one, 2] - half[other, 2] > limit
    )


@helper
def _least(shapes, piece, normal):
    """Return the least extent of a piece along a direction."""
    u, v, w = normal
    corners, least = shapes.corners.vertices, np.inf
    for k in range(shapes.corners.first[piece], shapes.corners.first[piece + 1]):
        along = u * corners[k, 0] + v * corners[k, 1] + w * corners[k, 2]
        least = along if along < least else least
    return least


@helper
def _keep_greater(normal, offset, shift, best):
    """Write a plane to `best` if its gap is the greatest so far: normal, offset, gap."""
    u, v, w = normal
    gap = u * shift[0] + v * shift[1] + w * shift[2] - offset
    if gap > best[4]:
        best[0], best[1], best[2], best[3], best[4] = u, v, w, offset, gap


@helper
def _try(shapes, one, other, normal, shift, clearance, best):
    u, v, w = normal
    offset = clearance - _least(shapes, other, (-u, -v, -w)) - _least(shapes, one, normal)
    _keep_greater(normal, offset, shift, best)


@helper
def _try_axes(shapes, one, other, shift, clearance, best):
    centre, half = shapes.corners.centre, shapes.corners.half
    for axis in range(3):
        between = centre[one, axis] + shift[axis] - centre[other, axis]
        gap = abs(between) - half[one, axis] - half[other, axis] - clearance
        if gap > best[4]:
            sign = 1.0 if between > 0.0 else -1.0
            best[0], best[1], best[2], best[4] = 0.0, 0.0, 0.0, gap
            best[axis] = sign
            best[3] = sign * shift[axis] - gap


@helper
def _try_faces(shapes, one, other, shift, clearance, limit, best):
    """Try the normals of both pieces; end at a gap beyond the limit."""
    for turn in range(2):
        faced, facing, sign = (other, one, 1.0) if turn == 0 else (one, other, -1.0)
        for k in range(shapes.first_normal[faced], shapes.first_normal[faced + 1]):
            normal = shapes.normals[k, 0], shapes.normals[k, 1], shapes.normals[k, 2]
            offset = clearance + shapes.reach[k] - _least(shapes, facing, normal)
            _keep_greater((sign * normal[0], sign * normal[1], sign * normal[2]), offset, shift, best)
            if best[4] > limit:
                return


@helper
def _try_edges(shapes, one, other, shift, clearance, limit, best):
    """Try the normals of an edge of each piece; end at a gap beyond the limit."""
    edges = shapes.edges
    for i in range(shapes.first_edge[one], shapes.first_edge[one + 1]):
        for j in range(shapes.first_edge[other], shapes.first_edge[other + 1]):
            u = edges[i, 1] * edges[j, 2] - edges[i, 2] * edges[j, 1]
            v = edges[i, 2] * edges[j, 0] - edges[i, 0] * edges[j, 2]
            w = edges[i, 0] * edges[j, 1] - edges[i, 1] * edges[j, 0]
            length = np.sqrt(u * u + v * v + w * w)
            if length > 1e-6:
                u, v, w = u / length, v / length, w / length
                _try(shapes, one, other, (u, v, w), shift, clearance, best)
                _try(shapes, one, other, (-u, -v, -w), shift, clearance, best)
                if best[4] > limit:
                    return


@helper
def _try_nearest(shapes, one, other, shift, clearance, work):
    """Try the normal from the nearest point of one piece to that of the other."""
    best, pose, simplex = work[0], work[1:4], work[4:8]
    pose[0, 3], pose[1, 3], pose[2, 3] = -shift[0], -shift[1], -shift[2]
    pieces = shapes.corners
    distance, u, v, w = pair_distance(pieces, one, pieces, other, pose, 0.0, np.inf, simplex)
    length = np.sqrt(u * u + v * v + w * w)
    if distance > 0.0 and length > 0.0:
        _try(shapes, one, other, (u / length, v / length, w / length), shift, clearance, best)


@helper
def _find_plane(shapes, one, other, shift, clearance, reach, work):
    """Write a plane between two pieces, the first one moved, to the work array: normal, offset, gap."""
    best = work[0]
    best[4] = -np.inf
    _try_axes(shapes, one, other, shift, clearance, best)
    if best[4] <= reach:
        _try_faces(shapes, one, other, shift, clearance, reach, best)
    if best[4] <= reach:
        _try_edges(shapes, one, other, shift, clearance, reach, best)
    if best[4] < 0.0:
        _try_nearest(shapes, one, other, shift, clearance, work)


@njit(cache=True, nogil=True, _nrt=False)
def find_contacts(
    shapes: ContactShapes,
    layout: ShapeLayout,
    items: int,
    reach: float,
    pairs: Int64s,
    planes: Floats,
    work: Floats,
) -> tuple[int, float]:
    """Write a plane for each pair of near pieces; return their number and the least gap (mm).

    Items i and j are apart if ``normal @ (position i - position j) >= offset`` for every contact of the two. The
    arrays may be too short: then the number says how many rows are needed.

    Parameters
    ----------
    items
        Number of items; obstacles follow.
    reach
        Pieces with a gap beyond this (mm) are left out.
    pairs, planes
        ``(k, 2)`` items i and j, and ``(k, 4)`` normal and offset; written.
    work
        Of the shape `WORK`, modified.
    """
    best, pose = work[0], work[1:4]
    for row in range(3):
        for column in range(3):
            pose[row, column] = 1.0 if row == column else 0.0
    count, worst = 0, np.inf
    for i in range(items):
        a = layout.shape[i]
        for j in range(layout.shape.size):
            if (i <= j < items) or (layout.build[i] != layout.build[j] and layout.build[j] != EVERYWHERE):
                continue
            b = layout.shape[j]
            x = layout.position[i, 0] - layout.position[j, 0]
            y = layout.position[i, 1] - layout.position[j, 1]
            z = layout.position[i, 2] - layout.position[j, 2]
            shift, clearance = (x, y, z), shapes.clearance[b]
            box, other = shapes.box[a], shapes.box[b]
            limit = reach + clearance
            if (
                max(box[0] + x - other[3], other[0] - box[3] - x) > limit
                or max(box[1] + y - other[4], other[1] - box[4] - y) > limit
                or max(box[2] + z - other[5], other[2] - box[5] - z) > limit
            ):
                continue
            for p in range(shapes.first[a], shapes.first[a + 1]):
                for q in range(shapes.first[b], shapes.first[b + 1]):
                    if _boxes_apart(shapes, p, q, shift, limit):
                        continue
                    _find_plane(shapes, p, q, shift, clearance, reach, work)
                    if best[4] > reach:
                        continue
                    worst = min(worst, best[4])
                    if count < planes.shape[0]:
                        pairs[count, 0], pairs[count, 1] = i, j
                        for axis in range(4):
                            planes[count, axis] = best[axis]
                    count += 1
    return count, worst
