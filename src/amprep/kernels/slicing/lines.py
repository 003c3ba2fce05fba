"""Trace the lines in which horizontal planes cut a surface without thickness.

Strategy. Triangles of a surface may face either way, so a line is walked without regard to their orientation: a plane
that cuts a triangle crosses two of its edges, and the twin of the one by which the walk leaves is the one by which it
enters the next triangle. Lines with ends are walked first, each from an end; what is left are closed lines.
"""

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted
from amprep.kernels.slicing.contours import LevelRows, LinkedTriangles, TracedContours


@uncounted
def _crossed(triangles: Int64s, level: Int64s, t: int, plane: int, other_than: int) -> int:
    """Return the first half-edge of a triangle that a plane crosses, apart from a given one."""
    for c in range(3):
        half = 3 * t + c
        if half != other_than and (level[triangles[t, c]] >= plane) != (
            level[triangles[t, (c + 1) % 3]] >= plane
        ):
            return half
    return -1


@uncounted
def _add_crossing(
    mesh: LinkedTriangles, level: Int64s, half: int, at: tuple[int, float], found: TracedContours, count: int
) -> None:
    """Write the point in which a plane (number and height) crosses a half-edge."""
    plane, height = at
    t, c = half // 3, half % 3
    a, b = mesh.triangles[t, c], mesh.triangles[t, (c + 1) % 3]
    if level[a] < plane:
        a, b = b, a
    fraction = (height - mesh.points[b, 2]) / (mesh.points[a, 2] - mesh.points[b, 2])
    for k in range(2):
        found.points[count, k] = mesh.points[b, k] + fraction * (mesh.points[a, k] - mesh.points[b, k])


@kernel
def trace_lines(
    mesh: LinkedTriangles,
    heights: Floats,
    level: Int64s,
    rows: LevelRows,
    is_seen: Bools,
    found: TracedContours,
) -> int:
    """Walk along all lines and return their number; the last point of a closed line is its first one.

    Parameters
    ----------
    mesh, heights, level, rows, is_seen
        See `amprep.kernels.slicing.contours.trace_contours`.
    found
        Filled in place; ``2 r`` points, and areas of 0.
    """
    lines, count = 0, 0
    for closed in range(2):
        for begin in range(len(rows.first)):
            last = rows.start[begin + 1] if begin + 1 < len(rows.first) else len(is_seen)
            for first_row in range(rows.start[begin], last):
                if is_seen[first_row]:
                    continue
                plane = rows.first[begin] + first_row - rows.start[begin]
                entry = _crossed(mesh.triangles, level, begin, plane, -1)
                if closed == 0 and mesh.twin[entry] >= 0:
                    entry = _crossed(mesh.triangles, level, begin, plane, entry)
                    if mesh.twin[entry] >= 0:
                        continue
                at = (plane, heights[plane])
                found.first[lines], found.plane[lines] = count, plane
                found.triangle[lines], found.area[lines] = begin, 0.0
                _add_crossing(mesh, level, entry, at, found, count)
                count += 1
                t, row = begin, first_row
                while not is_seen[row]:
                    is_seen[row] = True
                    leaving = _crossed(mesh.triangles, level, t, plane, entry)
                    _add_crossing(mesh, level, leaving, at, found, count)
                    count += 1
                    entry = mesh.twin[leaving]
                    if entry < 0:
                        break
                    t = entry // 3
                    row = rows.start[t] + plane - rows.first[t]
                lines += 1
    found.first[lines] = count
    return lines
