"""Recognise bores and domes: overhang regions whose vertices are on a cylinder or a sphere."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.overhangs.carried.borders import RegionFaces

_FLAT = 1e-4
"""Largest spread of unit normals out of a plane (mean square) for which a region is a cylinder."""

_NEAR = 0.01
"""Largest distance of vertices from the surface fitted to them, as a fraction of its radius, and in mm."""

_IN_LINE = 1e-4
"""Distance (mm) from the line between its neighbours up to which a vertex is inside a facet, not at its corner."""

_ALONG = 1e-3
"""Greatest cosine of the angle between the axis of a cylinder and the normals of faces that may belong to it."""

ANY_CHORD = 1e9
"""Limit (mm) of chords in regions whose diameter is known and within its limit."""

_FEWEST_LINES, _FEWEST_POINTS = 4, 8
"""Fewest lines of vertices that define a cylinder, and fewest vertices that define a sphere."""


def fitted_bores(regions: RegionFaces, normals: Floats, count: int) -> tuple[Floats, Floats]:
    """Return the diameter (mm) of the cylinder or sphere that each of `count` regions is part of, else NaN.

    The other array ``(count, 2)`` is the rise of the axis of cylinders, mm per mm along x and y, else 0. Two faces
    define a cylinder only together with the faces beside them: a roof ridge is none.

    Parameters
    ----------
    regions
        The faces of all regions.
    normals
        ``(m, 3)`` unit normals of all faces of the surface.
    count
        Number of regions.
    """
    diameters, tilts = np.full(count, np.nan), np.zeros((count, 2))
    order, beside = (np.argsort(each, kind="stable") for each in (regions.label, regions.outer_label))
    first, last = (
        np.searchsorted(regions.outer_label[beside], np.arange(count), side=s) for s in ("left", "right")
    )
    for group in np.split(order, np.flatnonzero(np.diff(regions.label[order])) + 1):
        if len(group) >= _FEWEST_LINES:
            own = regions.label[group[0]]
            rows = beside[first[own] : last[own]]
            outer = regions.outer[rows], regions.outer_normal[rows]
            diameters[own], tilts[own] = _bore(regions.corners[group], normals[regions.face[group]], outer)
    return diameters, tilts


def _bore(corners: Floats, normals: Floats, outer: tuple[Floats, Floats]) -> tuple[float, Floats]:
    """Return diameter and rise of the axis of one region with the corners ``(n, 3, 3)``.

    `outer` are points beyond the border, and the normals of their faces. The normals of a cylinder are in a plane
    through 0, those of a cone in another plane.
    """
    weight = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weight /= weight.sum()
    spread, weighted = np.einsum("n,ni,nj->ij", weight, normals, normals), weight @ normals
    values, axes = np.linalg.eigh(spread)
    points = corners.reshape(-1, 3)
    level = np.zeros(2)
    if values[1] < _FLAT:
        return float("nan"), level
    if values[0] < _FLAT:
        axis, across = axes[:, 0], axes[:, 1:]
        section = _corners_of(points @ across, weighted @ across)
        if len(section) < _FEWEST_LINES:
            more = outer[0][np.abs(outer[1] @ axis) < _ALONG]
            section = _corners_of(np.concatenate([points, more]) @ across, weighted @ across)
        tilt = axis[2] * axis[:2] / max(float(axis[:2] @ axis[:2]), 1e-12)
        return _fitted(section) if len(section) >= _FEWEST_LINES else float("nan"), tilt
    is_cone = np.linalg.eigvalsh(spread - np.outer(weighted, weighted))[0] < _FLAT
    return float("nan") if is_cone or len(points) < _FEWEST_POINTS else _fitted(_distinct(points)), level


def _corners_of(points: Floats, normal: Floats) -> Floats:
    """Return the points ``(n, 2)`` of the section of an arch at which its facets meet, and its two ends.

    Parameters
    ----------
    points
        Vertices in the section, some of them inside facets.
    normal
        ``(2,)`` mean normal of the facets.
    """
    points = _distinct(points)
    up = normal / max(float(np.linalg.norm(normal)), 1e-12)
    side = points @ np.array([-up[1], up[0]])
    middle = points.mean(axis=0)
    if (middle - points[[side.argmin(), side.argmax()]].mean(axis=0)) @ up < 0:
        up = -up
    offset = points - middle
    order = np.argsort(np.arctan2(offset @ np.array([-up[1], up[0]]), offset @ up), kind="stable")
    kept: list[int] = []
    for each in order.tolist():
        while len(kept) > 1 and _off_line(points[kept[-1]], points[kept[-2]], points[each]) < _IN_LINE:
            kept.pop()
        kept.append(each)
    return points[kept]


def _off_line(point: Floats, start: Floats, end: Floats) -> float:
    """Return the distance of a point in plan from the line between two others."""
    (ax, ay), (bx, by) = (point - start).tolist(), (end - start).tolist()
    return float(abs(ax * by - ay * bx) / max((bx * bx + by * by) ** 0.5, 1e-12))


def _distinct(points: Floats) -> Floats:
    """Return one of all points that are the same to a thousandth of a millimetre."""
    return points[np.unique(np.round(points, 3), axis=0, return_index=True)[1]]


def _fitted(points: Floats) -> float:
    """Return the diameter of the circle or sphere through points ``(n, 2 or 3)``, or NaN if there is none.

    Least squares in the equation of the circle, which is linear in its centre (Kasa 1976, doi
    10.1109/TIM.1976.6312298).
    """
    points = points - points.mean(axis=0)
    terms = np.column_stack([2 * points, np.ones(len(points))])
    solution, _, rank, _ = np.linalg.lstsq(terms, (points**2).sum(axis=1), rcond=None)
    centre = solution[:-1]
    square = float(solution[-1] + centre @ centre)
    if rank < terms.shape[1] or square <= 0:
        return float("nan")
    radius = square**0.5
    off = np.abs(np.linalg.norm(points - centre, axis=1) - radius).max()
    return 2 * radius if off <= _NEAR * min(radius, 1.0) + 2e-3 else float("nan")


def arch_limits(diameters: Floats, label: Int64s, bore: float, angle_deg: float) -> Floats:
    """Return the largest chord (mm) of an arch that carries itself, for each face.

    Parameters
    ----------
    diameters
        ``(n,)`` diameter of each region, NaN where it is no cylinder or sphere.
    label
        ``(m,)`` region of each face.
    bore
        Largest diameter of a horizontal bore, mm.
    angle_deg
        Overhang angle: a bore is flatter than it over the width ``diameter * sin(angle)``.
    """
    width = bore * float(np.sin(np.radians(angle_deg)))
    limit = np.where(np.isnan(diameters), width, np.where(diameters <= bore, ANY_CHORD, 0.0))
    return np.asarray(limit[label], np.float64)
