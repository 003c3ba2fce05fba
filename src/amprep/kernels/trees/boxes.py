"""Pairs of oriented boxes: separation, and the interval of travel on which they overlap."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import inlined
from amprep.kernels.trees.records import AXES, CENTRE, HALF, RADIUS, Frame, Vector, moved, turned

# Strategy. Two boxes are disjoint if and only if their shadows on one of 15 axes are: the three axes of each, and the
# nine cross products (Gottschalk, Lin, Manocha 1996). The tests run in the frame of the second box and stop at the
# first axis that separates. Boxes are inflated by the margin on every axis; the cross products have length at most 1,
# so no pair within the margin is dropped. `PARALLEL` is added to the cosines: nearly parallel edges separate nothing.

PARALLEL = 1e-9

STILL = 1e-14
"""Least rate at which shadows approach along an axis; slower ones count as if they had it."""


@inlined
def _centre_and_axes(
    a: Floats, i: int, b: Floats, j: int, frame: Frame
) -> tuple[Vector, Vector, Vector, Vector]:
    """Return the centre of box i relative to that of box j, and the axes of box i, in the frame of the second body."""
    x, y, z = moved(frame, a[i, CENTRE], a[i, CENTRE + 1], a[i, CENTRE + 2])
    return (
        (x - b[j, CENTRE], y - b[j, CENTRE + 1], z - b[j, CENTRE + 2]),
        turned(frame, a[i, AXES], a[i, AXES + 1], a[i, AXES + 2]),
        turned(frame, a[i, AXES + 3], a[i, AXES + 4], a[i, AXES + 5]),
        turned(frame, a[i, AXES + 6], a[i, AXES + 7], a[i, AXES + 8]),
    )


@inlined
def _dot(nodes: Floats, i: int, column: int, v: Vector) -> float:
    return nodes[i, column] * v[0] + nodes[i, column + 1] * v[1] + nodes[i, column + 2] * v[2]


@inlined
def _inner(u: Vector, v: Vector) -> float:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@inlined
def boxes_apart(a: Floats, i: int, b: Floats, j: int, frame: Frame, margin: float) -> bool:
    """Return whether an axis separates box i from box j by more than a margin.

    Parameters
    ----------
    a, b
        Nodes of two trees.
    frame
        Takes coordinates of the first body to those of the second.
    margin
        mm.
    """
    x, y, z = moved(frame, a[i, CENTRE], a[i, CENTRE + 1], a[i, CENTRE + 2])
    d = (x - b[j, CENTRE], y - b[j, CENTRE + 1], z - b[j, CENTRE + 2])
    reach = a[i, RADIUS] + b[j, RADIUS] + margin
    if _inner(d, d) > reach * reach:
        return True
    u0 = turned(frame, a[i, AXES], a[i, AXES + 1], a[i, AXES + 2])
    u1 = turned(frame, a[i, AXES + 3], a[i, AXES + 4], a[i, AXES + 5])
    u2 = turned(frame, a[i, AXES + 6], a[i, AXES + 7], a[i, AXES + 8])
    g0, g1, g2 = a[i, HALF], a[i, HALF + 1], a[i, HALF + 2]
    h0, h1, h2 = b[j, HALF], b[j, HALF + 1], b[j, HALF + 2]
    r00, r01, r02 = _dot(b, j, AXES, u0), _dot(b, j, AXES, u1), _dot(b, j, AXES, u2)
    f00, f01, f02 = abs(r00) + PARALLEL, abs(r01) + PARALLEL, abs(r02) + PARALLEL
    t0 = _dot(b, j, AXES, d)
    if abs(t0) > h0 + g0 * f00 + g1 * f01 + g2 * f02 + margin:
        return True
    r10, r11, r12 = _dot(b, j, AXES + 3, u0), _dot(b, j, AXES + 3, u1), _dot(b, j, AXES + 3, u2)
    f10, f11, f12 = abs(r10) + PARALLEL, abs(r11) + PARALLEL, abs(r12) + PARALLEL
    t1 = _dot(b, j, AXES + 3, d)
    if abs(t1) > h1 + g0 * f10 + g1 * f11 + g2 * f12 + margin:
        return True
    r20, r21, r22 = _dot(b, j, AXES + 6, u0), _dot(b, j, AXES + 6, u1), _dot(b, j, AXES + 6, u2)
    f20, f21, f22 = abs(r20) + PARALLEL, abs(r21) + PARALLEL, abs(r22) + PARALLEL
    t2 = _dot(b, j, AXES + 6, d)
    if abs(t2) > h2 + g0 * f20 + g1 * f21 + g2 * f22 + margin:
        return True
    if abs(_inner(u0, d)) > g0 + h0 * f00 + h1 * f10 + h2 * f20 + margin:
        return True
    if abs(_inner(u1, d)) > g1 + h0 * f01 + h1 * f11 + h2 * f21 + margin:
        return True
    if abs(_inner(u2, d)) > g2 + h0 * f02 + h1 * f12 + h2 * f22 + margin:
        return True
    if abs(t2 * r10 - t1 * r20) > h1 * f20 + h2 * f10 + g1 * f02 + g2 * f01 + margin:
        return True
    if abs(t2 * r11 - t1 * r21) > h1 * f21 + h2 * f11 + g0 * f02 + g2 * f00 + margin:
        return True
    if abs(t2 * r12 - t1 * r22) > h1 * f22 + h2 * f12 + g0 * f01 + g1 * f00 + margin:
        return True
    if abs(t0 * r20 - t2 * r00) > h0 * f20 + h2 * f00 + g1 * f12 + g2 * f11 + margin:
        return True
    if abs(t0 * r21 - t2 * r01) > h0 * f21 + h2 * f01 + g0 * f12 + g2 * f10 + margin:
        return True
    if abs(t0 * r22 - t2 * r02) > h0 * f22 + h2 * f02 + g0 * f11 + g1 * f10 + margin:
        return True
    if abs(t1 * r00 - t0 * r10) > h0 * f10 + h1 * f00 + g1 * f22 + g2 * f21 + margin:
        return True
    if abs(t1 * r01 - t0 * r11) > h0 * f11 + h1 * f01 + g0 * f22 + g2 * f20 + margin:
        return True
    return abs(t1 * r02 - t0 * r12) > h0 * f12 + h1 * f02 + g0 * f21 + g1 * f20 + margin


@inlined
def _later(low: float, high: float, at: float, rate: float, reach: float) -> tuple[float, float]:
    """Return an interval of travel without the times at which shadows are apart by more than `reach`."""
    rate = rate if abs(rate) > STILL else STILL
    inverse = 1.0 / rate
    middle, half = -at * inverse, reach * abs(inverse)
    return max(low, middle - half), min(high, middle + half)


@inlined
def first_overlap(
    a: Floats, i: int, b: Floats, j: int, frame: Frame, direction: Vector, margin: float, limit: float
) -> float:
    """Return a lower bound of the travel of box i until it is within a margin of box j; infinity if there is none.

    On each of the 15 axes the shadows overlap on an interval of travel; the boxes overlap on the intersection.

    Parameters
    ----------
    a, b
        Nodes of two trees.
    frame
        Takes coordinates of the first body to those of the second.
    direction
        Unit vector in coordinates of the second body.
    margin, limit
        mm; travel beyond the limit is not searched.
    """
    d, u0, u1, u2 = _centre_and_axes(a, i, b, j, frame)
    g0, g1, g2 = a[i, HALF], a[i, HALF + 1], a[i, HALF + 2]
    h0, h1, h2 = b[j, HALF], b[j, HALF + 1], b[j, HALF + 2]
    low, high = 0.0, limit
    r00, r01, r02 = _dot(b, j, AXES, u0), _dot(b, j, AXES, u1), _dot(b, j, AXES, u2)
    f00, f01, f02 = abs(r00) + PARALLEL, abs(r01) + PARALLEL, abs(r02) + PARALLEL
    t0, v0 = _dot(b, j, AXES, d), _dot(b, j, AXES, direction)
    low, high = _later(low, high, t0, v0, h0 + g0 * f00 + g1 * f01 + g2 * f02 + margin)
    r10, r11, r12 = _dot(b, j, AXES + 3, u0), _dot(b, j, AXES + 3, u1), _dot(b, j, AXES + 3, u2)
    f10, f11, f12 = abs(r10) + PARALLEL, abs(r11) + PARALLEL, abs(r12) + PARALLEL
    t1, v1 = _dot(b, j, AXES + 3, d), _dot(b, j, AXES + 3, direction)
    low, high = _later(low, high, t1, v1, h1 + g0 * f10 + g1 * f11 + g2 * f12 + margin)
    r20, r21, r22 = _dot(b, j, AXES + 6, u0), _dot(b, j, AXES + 6, u1), _dot(b, j, AXES + 6, u2)
    f20, f21, f22 = abs(r20) + PARALLEL, abs(r21) + PARALLEL, abs(r22) + PARALLEL
    t2, v2 = _dot(b, j, AXES + 6, d), _dot(b, j, AXES + 6, direction)
    low, high = _later(low, high, t2, v2, h2 + g0 * f20 + g1 * f21 + g2 * f22 + margin)
    if low > high:
        return np.inf
    low, high = _later(
        low, high, _inner(u0, d), _inner(u0, direction), g0 + h0 * f00 + h1 * f10 + h2 * f20 + margin
    )
    low, high = _later(
        low, high, _inner(u1, d), _inner(u1, direction), g1 + h0 * f01 + h1 * f11 + h2 * f21 + margin
    )
    low, high = _later(
        low, high, _inner(u2, d), _inner(u2, direction), g2 + h0 * f02 + h1 * f12 + h2 * f22 + margin
    )
    if low > high:
        return np.inf
    reach = h1 * f20 + h2 * f10 + g1 * f02 + g2 * f01 + margin
    low, high = _later(low, high, t2 * r10 - t1 * r20, v2 * r10 - v1 * r20, reach)
    reach = h1 * f21 + h2 * f11 + g0 * f02 + g2 * f00 + margin
    low, high = _later(low, high, t2 * r11 - t1 * r21, v2 * r11 - v1 * r21, reach)
    reach = h1 * f22 + h2 * f12 + g0 * f01 + g1 * f00 + margin
    low, high = _later(low, high, t2 * r12 - t1 * r22, v2 * r12 - v1 * r22, reach)
    reach = h0 * f20 + h2 * f00 + g1 * f12 + g2 * f11 + margin
    low, high = _later(low, high, t0 * r20 - t2 * r00, v0 * r20 - v2 * r00, reach)
    reach = h0 * f21 + h2 * f01 + g0 * f12 + g2 * f10 + margin
    low, high = _later(low, high, t0 * r21 - t2 * r01, v0 * r21 - v2 * r01, reach)
    reach = h0 * f22 + h2 * f02 + g0 * f11 + g1 * f10 + margin
    low, high = _later(low, high, t0 * r22 - t2 * r02, v0 * r22 - v2 * r02, reach)
    if low > high:
        return np.inf
    reach = h0 * f10 + h1 * f00 + g1 * f22 + g2 * f21 + margin
    low, high = _later(low, high, t1 * r00 - t0 * r10, v1 * r00 - v0 * r10, reach)
    reach = h0 * f11 + h1 * f01 + g0 * f22 + g2 * f20 + margin
    low, high = _later(low, high, t1 * r01 - t0 * r11, v1 * r01 - v0 * r11, reach)
    reach = h0 * f12 + h1 * f02 + g0 * f21 + g1 * f20 + margin
    low, high = _later(low, high, t1 * r02 - t0 * r12, v1 * r02 - v0 * r12, reach)
    return low if low <= high else np.inf


@inlined
def distance_bound(a: Floats, i: int, b: Floats, j: int, frame: Frame, limit: float) -> float:
    """Return a lower bound of the distance of two boxes; infinity as soon as it is at least a limit.

    The six axes of the boxes are used, without the nine cross products. The axes of one box are at right angles, so the
    root of the sum of the squared gaps along them is a bound; the greater one of both boxes is taken.

    Parameters
    ----------
    a, b
        Nodes of two trees.
    frame
        Takes coordinates of the first body to those of the second.
    limit
        mm.
    """
    x, y, z = moved(frame, a[i, CENTRE], a[i, CENTRE + 1], a[i, CENTRE + 2])
    d = (x - b[j, CENTRE], y - b[j, CENTRE + 1], z - b[j, CENTRE + 2])
    reach = a[i, RADIUS] + b[j, RADIUS] + limit
    if _inner(d, d) >= reach * reach:
        return np.inf
    u0 = turned(frame, a[i, AXES], a[i, AXES + 1], a[i, AXES + 2])
    u1 = turned(frame, a[i, AXES + 3], a[i, AXES + 4], a[i, AXES + 5])
    u2 = turned(frame, a[i, AXES + 6], a[i, AXES + 7], a[i, AXES + 8])
    g0, g1, g2 = a[i, HALF], a[i, HALF + 1], a[i, HALF + 2]
    h0, h1, h2 = b[j, HALF], b[j, HALF + 1], b[j, HALF + 2]
    r00, r01, r02 = _dot(b, j, AXES, u0), _dot(b, j, AXES, u1), _dot(b, j, AXES, u2)
    r10, r11, r12 = _dot(b, j, AXES + 3, u0), _dot(b, j, AXES + 3, u1), _dot(b, j, AXES + 3, u2)
    r20, r21, r22 = _dot(b, j, AXES + 6, u0), _dot(b, j, AXES + 6, u1), _dot(b, j, AXES + 6, u2)
    f00, f01, f02, f10, f11, f12 = abs(r00), abs(r01), abs(r02), abs(r10), abs(r11), abs(r12)
    f20, f21, f22 = abs(r20), abs(r21), abs(r22)
    t0, t1, t2 = _dot(b, j, AXES, d), _dot(b, j, AXES + 3, d), _dot(b, j, AXES + 6, d)
    p0 = max(0.0, abs(t0) - h0 - g0 * f00 - g1 * f01 - g2 * f02)
    p1 = max(0.0, abs(t1) - h1 - g0 * f10 - g1 * f11 - g2 * f12)
    p2 = max(0.0, abs(t2) - h2 - g0 * f20 - g1 * f21 - g2 * f22)
    q0 = max(0.0, abs(_inner(u0, d)) - g0 - h0 * f00 - h1 * f10 - h2 * f20)
    q1 = max(0.0, abs(_inner(u1, d)) - g1 - h0 * f01 - h1 * f11 - h2 * f21)
    q2 = max(0.0, abs(_inner(u2, d)) - g2 - h0 * f02 - h1 * f12 - h2 * f22)
    bound = np.sqrt(max(p0 * p0 + p1 * p1 + p2 * p2, q0 * q0 + q1 * q1 + q2 * q2))
    if bound >= limit:
        return np.inf
    return bound
