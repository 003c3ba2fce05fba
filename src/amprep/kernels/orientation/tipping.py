"""Measure how far the centre of mass of a part is inside the outline of its lowest points, in many directions."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import kernel


@kernel
def measure_margins(
    points: Floats, centre: Floats, directions: Floats, base: float, plan: Floats, margins: Floats
) -> None:
    """Measure the distances of the centre of mass from the nearest side of the outline.

    The outline is wrapped side by side (Jarvis 1973, doi 10.1016/0020-0190(73)90020-3), since it has few corners.

    Parameters
    ----------
    points
        ``(n, 3)`` mm, corners of the convex hull of the part.
    centre
        ``(3,)`` mm.
    directions
        ``(k, 3)`` unit vectors that point up.
    base
        Height (mm) above the lowest point up to which points belong to the outline.
    plan
        ``(n, 3)`` scratch.
    margins
        ``(k,)`` out: mm; negative outside, and minus infinity where the outline has no area.
    """
    for k in range(len(directions)):
        x, y, z = directions[k, 0], directions[k, 1], directions[k, 2]
        low = np.inf
        for n in range(len(points)):
            plan[n, 2] = points[n, 0] * x + points[n, 1] * y + points[n, 2] * z
            low = min(low, plan[n, 2])
        # two level axes
        if abs(z) < 0.9:
            size = np.sqrt(x * x + y * y)
            ax, ay, az = -y / size, x / size, 0.0
        else:
            size = np.sqrt(y * y + z * z)
            ax, ay, az = 0.0, -z / size, y / size
        bx, by, bz = y * az - z * ay, z * ax - x * az, x * ay - y * ax
        cx = centre[0] * ax + centre[1] * ay + centre[2] * az
        cy = centre[0] * bx + centre[1] * by + centre[2] * bz
        count, first = 0, 0
        for n in range(len(points)):
            if plan[n, 2] <= low + base:
                plan[count, 0] = points[n, 0] * ax + points[n, 1] * ay + points[n, 2] * az - cx
                plan[count, 1] = points[n, 0] * bx + points[n, 1] * by + points[n, 2] * bz - cy
                if plan[count, 0] < plan[first, 0] or (
                    plan[count, 0] == plan[first, 0] and plan[count, 1] < plan[first, 1]
                ):
                    first = count
                count += 1
        margin, area, at = np.inf, 0.0, first
        for _ in range(count):
            following = -1
            for n in range(count):
                dx, dy = plan[n, 0] - plan[at, 0], plan[n, 1] - plan[at, 1]
                if dx == 0.0 and dy == 0.0:
                    continue
                if following < 0:
                    following = n
                    continue
                ex, ey = plan[following, 0] - plan[at, 0], plan[following, 1] - plan[at, 1]
                turn = ex * dy - ey * dx
                if turn < 0.0 or (turn == 0.0 and dx * dx + dy * dy > ex * ex + ey * ey):
                    following = n
            if following < 0:
                break
            ex, ey = plan[following, 0] - plan[at, 0], plan[following, 1] - plan[at, 1]
            length = np.sqrt(ex * ex + ey * ey)
            margin = min(margin, (ey * plan[at, 0] - ex * plan[at, 1]) / length)
            area += plan[at, 0] * plan[following, 1] - plan[at, 1] * plan[following, 0]
            at = following
            if at == first:
                break
        margins[k] = margin if area > 1e-9 else -np.inf
