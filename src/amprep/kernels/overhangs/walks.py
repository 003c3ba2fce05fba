"""Walk from points of overhang regions to the borders of these, over their faces."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted

# Strategy. The faces of a region are flatter than 90 degrees, so each of them is a triangle in plan, and a horizontal
# straight line over the region is a line from triangle to triangle through their common sides. In each triangle the
# line leaves through the side that it reaches first; there it enters the face beyond, or ends at the border. So
# regions that overlap themselves in plan are walked correctly. A walk takes a few nanoseconds a triangle.
# The walk towards the nearest anchor comes first. If it arrives, it is the shortest ledge; and the shortest line
# between two anchors through the point is often its continuation. All directions are tried only where these do not
# suffice. No line between two anchors is shorter than twice the shortest ledge.
# A walk ends where it can no longer matter: beyond the shortest ledge so far, and above the height up to which an
# anchor counts. Over a noisy mesh, whose triangles are small and many, this is nearly all of the time.
# Where only the verdict is asked, the direction that carried the point before is tried early, as points come in the
# order of the triangles; and a line ends where, with the least distance to an anchor on its other side, it is too long.

ANCHOR, FREE = -1, -2
"""What is beyond a side at the border of a region: the part carries it there, or it does not."""

FAR = -3
"""How a walk ends that is longer than asked."""

_CHORDS = 32
_MOST_STEPS = 100_000


class WalkableFaces(NamedTuple):
    """The faces of overhang regions, counter-clockwise seen from above.

    Attributes
    ----------
    corners
        ``(m, 3, 3)`` mm.
    beyond
        ``(m, 3)`` for the side from corner i to corner i + 1: 3 times the face beyond it, plus the number of the same
        side there; or `ANCHOR` or `FREE`.
    """

    corners: Floats
    beyond: Int64s


class CarryingLimits(NamedTuple):
    """Limits up to which the part carries points, and what ends a walk.

    Attributes
    ----------
    bridge
        Largest length of a bridge, mm.
    arch
        ``(m,)`` largest chord of an arch over each face, mm.
    rise
        Least rise of an arch as a fraction of its chord.
    tilt
        ``(m, 2)`` rise of the axis of the bore that each face is part of, mm per mm along x and y; 0 where unknown.
    most
        ``(m,)`` length (mm) at which walks from points of each face end.
    plate
        Height (mm) up to which a region is on the plate.
    climb
        ``(m,)`` how far (mm) a walk from a point of each face to what carries it may rise above the point.
    """

    bridge: float
    arch: Floats
    rise: float
    tilt: Floats
    most: Floats
    plate: float
    climb: Floats


class _WalkEnd(NamedTuple):
    """The end of a walk.

    Attributes
    ----------
    length, kind, face
        Length of the walk, what is beyond its end, and the face that it ends in.
    height, top
        Height at the end, and the greatest height on the way, mm.
    crown
        Greatest height above a line through the point that the walk starts from, mm.
    """

    length: float
    kind: int
    face: int
    height: float
    top: float
    crown: float


@uncounted
def walk(
    faces: WalkableFaces,
    face: int,
    point: tuple[float, float, float],
    direction: tuple[float, float],
    most: float,
    highest: float,
    plate: float,
    slope: float,
) -> _WalkEnd:
    """Walk from a point in a face; the crown is measured from a line with the slope given.

    The walk ends where it is longer than `most` mm or higher than `highest` mm.
    """
    corners, beyond = faces.corners, faces.beyond
    x, y, z = point
    dx, dy = direction
    came, length, top, height, crown = -1, 0.0, z, z, z
    for _ in range(_MOST_STEPS):
        best, side = np.inf, -1
        for i in range(3):
            if i != came:
                j = i + 1 if i < 2 else 0
                ex = corners[face, j, 0] - corners[face, i, 0]
                ey = corners[face, j, 1] - corners[face, i, 1]
                out = dx * ey - dy * ex
                if out > 1e-15:
                    at = ((corners[face, i, 0] - x) * ey - (corners[face, i, 1] - y) * ex) / out
                    if at < best:
                        best, side = at, i
        if side < 0:
            return _WalkEnd(length, FREE, face, height, top, crown)
        best = max(best, length)
        j = side + 1 if side < 2 else 0
        ex = corners[face, j, 0] - corners[face, side, 0]
        ey = corners[face, j, 1] - corners[face, side, 1]
        along = (x + best * dx - corners[face, side, 0]) * ex + (y + best * dy - corners[face, side, 1]) * ey
        along = min(max(along / (ex * ex + ey * ey), 0.0), 1.0)
        low = height
        height = corners[face, side, 2] + along * (corners[face, j, 2] - corners[face, side, 2])
        if height <= plate:
            share = (low - plate) / (low - height) if low > height else 0.0
            return _WalkEnd(length + share * (best - length), ANCHOR, face, plate, top, crown)
        top = max(top, height)
        length = best
        crown = max(crown, height - slope * length)
        if length > most or top > highest:
            return _WalkEnd(length, FAR, face, height, top, crown)
        onward = beyond[face, side]
        if onward < 0:
            return _WalkEnd(length, onward, face, height, top, crown)
        face, came = onward // 3, onward % 3
    return _WalkEnd(length, FREE, face, height, top, crown)


@uncounted
def _chord(
    faces: WalkableFaces,
    limits: CarryingLimits,
    face: int,
    point: tuple[float, float, float],
    direction: tuple[float, float],
    nearest: float,
    least: float,
) -> tuple[float, float]:
    """Return the bridge and the arch along a line through a point, infinite where there is none.

    One end of an arch is at most `nearest` mm from the point. No end is nearer than `least` mm.
    """
    dx, dy = direction
    slope = limits.tilt[face, 0] * dx + limits.tilt[face, 1] * dy
    printed = point[2] + limits.climb[face]
    one = walk(faces, face, point, (dx, dy), limits.most[face] - least, np.inf, limits.plate, slope)
    if one.kind != ANCHOR:
        return np.inf, np.inf
    highest = printed if one.top > printed else np.inf
    most = limits.most[face] - one.length
    other = walk(faces, face, point, (-dx, -dy), most, highest, limits.plate, -slope)
    if other.kind != ANCHOR:
        return np.inf, np.inf
    bridge = one.length + other.length
    feet = max(one.height - slope * one.length, other.height + slope * other.length)
    rise = max(one.crown, other.crown) - feet
    is_arch = rise >= limits.rise * bridge and min(one.length, other.length) <= nearest
    return bridge, bridge if is_arch else np.inf


@uncounted
def _direction(k: int, to_x: float, to_y: float) -> tuple[float, float]:
    """Return the direction of line k through a point: that to the nearest anchor, whose vector is given, if k < 0."""
    if k < 0:
        size = max(np.sqrt(to_x * to_x + to_y * to_y), 1e-12)
        return to_x / size, to_y / size
    return np.cos(np.pi * k / _CHORDS), np.sin(np.pi * k / _CHORDS)


@uncounted
def _towards(
    faces: WalkableFaces,
    limits: CarryingLimits,
    face: int,
    point: tuple[float, float, float],
    direction: tuple[float, float],
    most: float,
) -> float:
    """Return the length of a walk to an anchor, infinite where it does not lead to one within `most` mm."""
    highest = point[2] + limits.climb[face]
    end = walk(faces, face, point, direction, most, highest, limits.plate, 0.0)
    return end.length if end.kind == ANCHOR else np.inf


@kernel
def find_ledges(
    faces: WalkableFaces,
    limits: CarryingLimits,
    points: Floats,
    face: Int64s,
    targets: Floats,
    ledges: Floats,
) -> None:
    """Find the length of the shortest ledge at each point; parameters as of `find_spans`.

    Parameters
    ----------
    ledges
        ``(n,)`` out: mm, infinite where no straight line within the limit of walks leads to an anchor.
    """
    for n in range(len(points)):
        x, y, z = points[n]
        at = face[n]
        ledge = np.inf
        if z <= limits.plate:
            ledge = 0.0
        elif not np.isnan(targets[n, 0]):
            dx, dy = targets[n, 0] - x, targets[n, 1] - y
            size = max(np.sqrt(dx * dx + dy * dy), 1e-12)
            ledge = _towards(faces, limits, at, (x, y, z), (dx / size, dy / size), limits.most[at])
            if ledge > size + 1e-6:
                for k in range(2 * _CHORDS):
                    towards = (np.cos(np.pi * k / _CHORDS), np.sin(np.pi * k / _CHORDS))
                    most = min(ledge, limits.most[at])
                    ledge = min(ledge, _towards(faces, limits, at, (x, y, z), towards, most))
        ledges[n] = ledge


@kernel
def find_spans(
    faces: WalkableFaces,
    limits: CarryingLimits,
    points: Floats,
    face: Int64s,
    targets: Floats,
    nearest: Floats,
    spans: Floats,
) -> None:
    """Find the shortest bridge and arch through each point.

    Parameters
    ----------
    faces, limits
        The faces of the regions, and the limits.
    points, face
        ``(n, 3)`` mm, and the face ``(n,)`` that each is on.
    targets
        ``(n, 2)`` mm, the anchor nearest to each point; not a number if its region has none.
    nearest
        ``(n,)`` mm, largest distance of a point from the nearer end of an arch.
    spans
        ``(n, 2)`` out: length of the shortest bridge and of the shortest arch, mm.
    """
    for n in range(len(points)):
        x, y, z = points[n]
        bridge, arch = np.inf, np.inf
        if not np.isnan(targets[n, 0]):
            for k in range(-1, _CHORDS):
                towards = _direction(k, targets[n, 0] - x, targets[n, 1] - y)
                one, two = _chord(faces, limits, face[n], (x, y, z), towards, nearest[n], 0.0)
                bridge, arch = min(bridge, one), min(arch, two)
        spans[n, 0], spans[n, 1] = bridge, arch


@kernel
def find_spanned(
    faces: WalkableFaces,
    limits: CarryingLimits,
    points: Floats,
    face: Int64s,
    targets: Floats,
    nearest: Floats,
    least: Floats,
    spanned: Bools,
) -> None:
    """Tell through which points a bridge or an arch leads that is within its limit; parameters as of `find_spans`.

    Parameters
    ----------
    least
        ``(n,)`` mm, a lower bound on the distance of any anchor from each point.
    spanned
        ``(n,)``, filled.
    """
    before = 0
    for n in range(len(points)):
        x, y, z = points[n]
        at = face[n]
        spanned[n] = False
        if np.isnan(targets[n, 0]) or 2.0 * least[n] > limits.most[at]:
            continue
        for attempt in range(-1, _CHORDS + 1):
            k = before if attempt == 0 else attempt - 1 if attempt > 0 else -1
            if attempt > 0 and k == before:
                continue
            towards = _direction(k, targets[n, 0] - x, targets[n, 1] - y)
            bridge, arch = _chord(faces, limits, at, (x, y, z), towards, nearest[n], least[n])
            if bridge <= limits.bridge or arch <= limits.arch[at]:
                spanned[n] = True
                before = before if k < 0 else k
                break
