"""Measure which fraction of each triangle the part itself carries when the triangle points straight down."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.kernels.helper import inlined, kernel

# Strategy. Whether the part carries a point of an overhang depends on the direction that points up, and the exact
# answer needs a search in each direction. But a triangle is an overhang only within the overhang angle of the
# direction in which it is level, and what carries it there usually carries it in the whole cone: the walls of a slot,
# the flanks of a bore, the wall above a ledge. So each triangle is judged once, level, and the answer serves for all
# directions. Lines lead from points of the triangle over the faces that are overhangs in this position. They end at an
# anchor by the same rule as those of the exact search, without its refinements: regions that start in the air, wide
# starts and fitted diameters. The final figures come from the exact search.

_LINES = 8
"""Number of lines through each point, each of which leads in two directions."""

_MOST_STEPS = 400

NO_FACE = -1


@inlined
def _along(points, point, axis):
    return points[point, 0] * axis[0] + points[point, 1] * axis[1] + points[point, 2] * axis[2]


@inlined
def _walk(surface, down, across, onward, face, start, steep, most):
    """Return length, whether it ends at an anchor, and the greatest depth against the start and at the end.

    The line leads in the direction `onward`, perpendicular to `across`; both are level where `down` points down.
    """
    points, triangles, normals, beyond = surface.points, surface.triangles, surface.normals, surface.beyond
    x0 = start[0] * onward[0] + start[1] * onward[1] + start[2] * onward[2]
    y0 = start[0] * across[0] + start[1] * across[1] + start[2] * across[2]
    z0 = start[0] * down[0] + start[1] * down[1] + start[2] * down[2]
    came, at, length, rise, end = NO_FACE, face, 0.0, 0.0, 0.0
    for _ in range(_MOST_STEPS):
        best, side = np.inf, -1
        for i in range(3):
            if i == came:
                continue
            j = i + 1 if i < 2 else 0
            p, q = triangles[at, i], triangles[at, j]
            ya, yb = _along(points, p, across) - y0, _along(points, q, across) - y0
            if (ya > 0.0) == (yb > 0.0):
                continue
            share = ya / (ya - yb)
            xa, xb = _along(points, p, onward) - x0, _along(points, q, onward) - x0
            reach = xa + share * (xb - xa)
            if reach >= length - 1e-9 and reach < best:
                best, side = reach, i
        if side < 0 or best > most:
            return most, False, rise, end
        length = max(best, length)
        p, q = triangles[at, side], triangles[at, side + 1 if side < 2 else 0]
        ya, yb = _along(points, p, across) - y0, _along(points, q, across) - y0
        share = ya / (ya - yb) if ya != yb else 0.5
        za, zb = _along(points, p, down) - z0, _along(points, q, down) - z0
        end = -(za + share * (zb - za))
        rise = max(rise, end)
        other = beyond[at, side]
        if other == NO_FACE:
            return length, False, rise, end
        face_beyond, came = other // 3, other % 3
        facing = _along(normals, face_beyond, down)
        if facing <= steep:
            return (
                length,
                _is_anchor(points, triangles, surface.straight, at, side, face_beyond, came, down, facing),
                rise,
                end,
            )
        at = face_beyond
    return most, False, rise, end


@inlined
def _is_anchor(points, triangles, straight, at, side, other, came, down, facing):
    """Tell whether the face beyond a side carries the one before it: it goes down, and the solid is beyond it."""
    p, q = triangles[other, came], triangles[other, came + 1 if came < 2 else 0]
    tip = triangles[other, came + 2 if came < 1 else came - 1]
    ex, ey, ez = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1], points[q, 2] - points[p, 2]
    rx, ry, rz = points[tip, 0] - points[p, 0], points[tip, 1] - points[p, 1], points[tip, 2] - points[p, 2]
    size = ex * ex + ey * ey + ez * ez
    share = (rx * ex + ry * ey + rz * ez) / size if size > 0.0 else 0.0
    depth = (rx - share * ex) * down[0] + (ry - share * ey) * down[1] + (rz - share * ez) * down[2]
    solid = straight[at, side]
    return (depth > 1e-9 and (solid or facing > 1e-6)) or (solid and facing < -1e-6)


class WalkedSurface(NamedTuple):
    """The triangles of a part, with what is beyond their sides.

    Attributes
    ----------
    points, triangles, normals
        ``(n, 3)`` mm, ``(m, 3)`` and ``(m, 3)``, unit vectors out of the solid.
    beyond
        ``(m, 3)`` for the side from corner i to corner i + 1: 3 times the face beyond it, plus the number of the same
        side there; `NO_FACE` at open edges and where more than two faces meet.
    straight
        ``(m, 3)`` 1 where the solid has an angle of at least 180 degrees at the side.
    """

    points: Floats
    triangles: Ints
    normals: Floats
    beyond: Ints
    straight: Ints


@kernel
def measure_carried(surface: WalkedSurface, samples: Ints, limits: Floats, carried: Floats) -> None:
    """Measure the carried fraction of each triangle.

    Parameters
    ----------
    surface
        The part.
    samples
        ``(m,)`` number of rows into which each triangle is divided for its sample points; 0 leaves the triangle out.
    limits
        ``(5,)`` cosine of the overhang angle, then ledge, bridge and chord of an arch, mm, and the least rise of an
        arch as a fraction of its chord.
    carried
        ``(m,)`` out: fraction of the sample points that the part carries.
    """
    points, triangles, normals = surface.points, surface.triangles, surface.normals
    steep, ledge, bridge, arch, least_rise = limits[0], limits[1], limits[2], limits[3], limits[4]
    longest = max(ledge, bridge, arch)
    for face in range(len(triangles)):
        rows = samples[face]
        carried[face] = 0.0
        if rows == 0:
            continue
        down = (normals[face, 0], normals[face, 1], normals[face, 2])
        a, b, c = triangles[face, 0], triangles[face, 1], triangles[face, 2]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        size = np.sqrt(ux * ux + uy * uy + uz * uz)
        if size == 0.0:
            continue
        ux, uy, uz = ux / size, uy / size, uz / size
        vx, vy, vz = down[1] * uz - down[2] * uy, down[2] * ux - down[0] * uz, down[0] * uy - down[1] * ux
        held, count = 0, 0
        for i in range(rows):
            for j in range(2 * i + 1):
                # centres of the smaller triangles, alternately upright and turned
                row = (i + 2.0 / 3.0 if j % 2 == 0 else i + 1.0 / 3.0) / rows
                column = (j // 2 + (1.0 / 3.0 if j % 2 == 0 else 2.0 / 3.0)) / rows
                wb, wc = row - column, column
                wa = 1.0 - wb - wc
                start = (
                    wa * points[a, 0] + wb * points[b, 0] + wc * points[c, 0],
                    wa * points[a, 1] + wb * points[b, 1] + wc * points[c, 1],
                    wa * points[a, 2] + wb * points[b, 2] + wc * points[c, 2],
                )
                count += 1
                for line in range(_LINES):
                    # the odd offset keeps lines off the vertices of regular meshes
                    turn = np.pi * (line + 0.37) / _LINES
                    co, si = np.cos(turn), np.sin(turn)
                    onward = (co * ux + si * vx, co * uy + si * vy, co * uz + si * vz)
                    across = (co * vx - si * ux, co * vy - si * uy, co * vz - si * uz)
                    one, held_one, rise_one, end_one = _walk(
                        surface, down, across, onward, face, start, steep, longest
                    )
                    back = (-onward[0], -onward[1], -onward[2])
                    two, held_two, rise_two, end_two = _walk(
                        surface, down, across, back, face, start, steep, longest
                    )
                    if (held_one and one <= ledge) or (held_two and two <= ledge):
                        held += 1
                        break
                    if held_one and held_two:
                        chord = one + two
                        crown = max(rise_one, rise_two, 0.0) - max(end_one, end_two)
                        if chord <= bridge or (chord <= arch and crown >= least_rise * chord):
                            held += 1
                            break
        carried[face] = held / count
