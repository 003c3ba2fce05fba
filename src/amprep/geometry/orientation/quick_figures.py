"""Quick figures of a part in many directions, before the exact ones of the best directions."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.orientation.surface import TurnableSurface
from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.faces import ANGLE_TOLERANCE_DEG

_SAMPLE_MM = 2.0
"""Distance (mm) of the sample points at which large triangles are judged."""

_MOST_ROWS = 6

_MERGING = 0.6


class QuickFigures(NamedTuple):
    """Figures of a part in ``k`` directions.

    Attributes
    ----------
    height
        ``(k,)`` mm, height of the part.
    overhang, plan
        ``(k,)`` mm2, area of the faces that need support, and their area in plan.
    shadow
        ``(k,)`` mm3, volume between these faces and the plate.
    edge_length, edge_shadow
        ``(k,)`` mm and mm2, length of the knife edges and the area between them and the plate.
    """

    height: Floats
    overhang: Floats
    plan: Floats
    shadow: Floats
    edge_length: Floats
    edge_shadow: Floats


def support_estimate(area: Floats, volume: Floats) -> Floats:
    """Return estimates of support from the area (mm2) in plan and the volume (mm3) of columns down to the plate.

    Supports merge on their way down. So the estimate is the area times the mean height to the power of 0.6, with which
    the volumes of planned supports of some 300 orientations of printer parts agree best.
    """
    return np.asarray(np.maximum(area, 0.0) ** (1.0 - _MERGING) * np.maximum(volume, 0.0) ** _MERGING)


def carried_fractions(surface: TurnableSurface, limits: Limits) -> Floats:
    """Return the fraction ``(m,)`` of each triangle that the part carries where the triangle points straight down.

    It stands for what the part carries in all directions in which the triangle is an overhang.

    Parameters
    ----------
    surface
        The surface.
    limits
        Overhang angle and limits.
    """
    from amprep.kernels.orientation.carried import WalkedSurface, measure_carried

    angle = np.radians(limits.angle_deg)
    rows = np.clip(np.ceil(np.sqrt(surface.areas) / _SAMPLE_MM), 1, _MOST_ROWS)
    samples = np.where(surface.areas > 0.0, rows, 0).astype(np.int64)
    carried = np.empty(len(surface.triangles))
    measure_carried(
        WalkedSurface(surface.points, surface.triangles, surface.normals, surface.beyond, surface.straight),
        samples,
        np.array(
            [
                np.cos(angle),
                limits.ledge,
                limits.bridge,
                limits.bore * np.sin(angle),
                np.tan(angle / 2.0) / 4.0 - 1e-3,
            ]
        ),
        carried,
    )
    return carried


def quick_figures(
    surface: TurnableSurface,
    directions: Floats,
    limits: Limits,
    *,
    lift: float,
    carried: Floats | None = None,
    enforced: Bools | None = None,
) -> QuickFigures:
    """Return the figures of a part in many directions.

    Parameters
    ----------
    surface
        The surface.
    directions
        ``(k, 3)`` unit vectors of the part that point up.
    limits
        Overhang angle, and the height up to which geometry is on the plate.
    lift
        Height (mm) of the lowest point of the part above the plate.
    carried
        ``(m,)`` fraction of each triangle that needs no support: the part carries it, or a blocker has it.
    enforced
        ``(m,)`` bool, triangles that need support wherever they point down.
    """
    from amprep.kernels.orientation import scores as columns

    angle = np.radians(max(limits.angle_deg - ANGLE_TOLERANCE_DEG, 0.0))
    steep = np.full(len(surface.triangles), np.cos(angle))
    if enforced is not None:
        steep[enforced] = 1e-6
    found = np.empty((len(directions), 6))
    faces = columns.ScoredFaces(
        surface.points,
        surface.triangles,
        surface.normals,
        surface.areas,
        np.ones(len(surface.triangles)) if carried is None else 1.0 - carried,
        steep,
    )
    columns.score_directions(
        faces,
        columns.ScoredEdges(surface.edges, surface.rays, surface.beside),
        np.ascontiguousarray(directions),
        np.array([lift, limits.plate, np.sin(angle), np.cos(angle)]),
        np.empty(len(surface.points)),
        found,
    )
    return QuickFigures(
        found[:, columns.HEIGHT],
        found[:, columns.AREA],
        found[:, columns.PLAN],
        found[:, columns.VOLUME],
        found[:, columns.EDGES],
        found[:, columns.UNDER_EDGES],
    )
