"""How firmly a part stands on the plate."""

import numpy as np

from amprep.arrays import Floats


def centre_of_mass(corners: Floats) -> Floats:
    """Return the centre of mass ``(3,)`` of a solid with the triangles ``(m, 3, 3)`` mm.

    Each triangle and the origin span a tetrahedron with a signed volume. A surface without volume has the centre of
    its area.
    """
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    total = float(volume.sum())
    if total > 1e-9 * float(np.abs(volume).sum()):
        return np.asarray(volume @ corners.sum(axis=1) / 4.0 / total)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.asarray(area @ corners.mean(axis=1) / max(float(area.sum()), 1e-300))


def tipping_angles(points: Floats, centre: Floats, directions: Floats, base: float) -> Floats:
    """Return the angles (degrees) by which a part must be tilted until it tips over, ``(k,)``.

    It tips over the nearest side of the convex outline of its lowest points; the angle is 0 if its centre of mass is
    beyond that side, or if it stands on a line or a point.

    Parameters
    ----------
    points
        ``(n, 3)`` mm, vertices of the part, or the corners of its convex hull.
    centre
        ``(3,)`` mm, centre of mass.
    directions
        ``(k, 3)`` unit vectors that point up.
    base
        Height (mm) above the lowest point up to which the part stands on the plate.
    """
    from amprep.kernels.orientation.tipping import measure_margins

    points = np.ascontiguousarray(points)
    margins = np.empty(len(directions))
    measure_margins(
        points, centre, np.ascontiguousarray(directions), base, np.empty((len(points), 3)), margins
    )
    heights = directions @ centre - (points @ directions.T).min(axis=0, initial=np.inf)
    return np.asarray(np.degrees(np.arctan2(np.maximum(margins, 0.0), np.maximum(heights, 1e-9))))
