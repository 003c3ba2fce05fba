"""Tell which points see the outside along one of some directions."""

from numba import njit

from amprep.arrays import Bools, Floats

_PARALLEL = 1e-12
"""Determinant below which a ray counts as parallel to a triangle."""


@njit(cache=True)
def look_outside(points: Floats, directions: Floats, corners: Floats, sees: Bools) -> None:
    """Set `sees` ``(n,)`` for each point from which a ray along some direction meets no triangle.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    directions
        ``(k, 3)``, of any length.
    corners
        ``(m, 3, 3)`` mm, corners of triangles.
    sees
        Result.
    """
    for i in range(len(points)):
        for d in range(len(directions)):
            if not sees[i]:
                sees[i] = _is_free(points[i], directions[d], corners)


@njit(cache=True)
def _is_free(point: Floats, direction: Floats, corners: Floats) -> bool:
    """Tell whether a ray meets no triangle (Moeller and Trumbore, 1997, doi:10.1080/10867651.1997.10487468)."""
    px, py, pz = point[0], point[1], point[2]
    dx, dy, dz = direction[0], direction[1], direction[2]
    for t in range(len(corners)):
        ax, ay, az = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
        ux, uy, uz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
        vx, vy, vz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
        hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
        det = ux * hx + uy * hy + uz * hz
        if abs(det) < _PARALLEL:
            continue
        sx, sy, sz = px - ax, py - ay, pz - az
        first = (sx * hx + sy * hy + sz * hz) / det
        if first < 0.0 or first > 1.0:
            continue
        qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
        second = (dx * qx + dy * qy + dz * qz) / det
        if second < 0.0 or first + second > 1.0:
            continue
        if (vx * qx + vy * qy + vz * qz) / det > 0.0:
            return False
    return True
