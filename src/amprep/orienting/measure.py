"""Measure what an orientation of a part costs, by the exact search for overhangs."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.orientation.quick_figures import support_estimate
from amprep.geometry.orientation.tipping import centre_of_mass, tipping_angles
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.orientation import EDGE_MM, FIRM_DEG, HOLD_MM2, OrientationFigures
from amprep.model.part import Part
from amprep.model.supports.rules import SupportRules
from amprep.orienting.faces import faces_named
from amprep.overhangs.of_part import overhangs_of


def stood(part: Part, rotation: Floats, lift: float) -> PlacedPart:
    """Return a part in an orientation ``(3, 3)``, its lowest point `lift` mm above the origin of the plate."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = [0.0, 0.0, lift - float((part.mesh.vertices @ rotation[2]).min())]
    return PlacedPart(part.name, part, matrix, part.orientations)


def measure_orientation(part: Part, rotation: Floats, rules: SupportRules, lift: float) -> OrientationFigures:
    """Return the figures of a part in an orientation.

    What needs support is what the planner finds, with the part's own settings, blockers and enforcers.

    Parameters
    ----------
    part
        The part.
    rotation
        ``(3, 3)``, part coordinates to build coordinates.
    rules
        Overhang angle and limits.
    lift
        Height (mm) of its lowest point above the plate.
    """
    placed = stood(part, rotation, lift)
    own = overhangs_of(placed, rules)
    found, points = own.overhangs, own.mesh.vertices
    corners = points[own.mesh.triangles[found.faces]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ends = points[found.edges]
    whole = placed.mesh.vertices[placed.mesh.triangles]
    centre = centre_of_mass(whole)
    tipping = float(tipping_angles(placed.mesh.vertices, centre, np.eye(3)[2:], rules.plate_mm)[0])
    shadow = float(-cross[:, 2] @ corners[:, :, 2].mean(axis=1) / 2.0) + 0.0
    along = ends[:, 1] - ends[:, 0]
    below = float(np.hypot(along[:, 0], along[:, 1]) @ ends[:, :, 2].mean(axis=1))
    held = tipping >= FIRM_DEG or lift > rules.plate_mm
    hold = 0.0 if held else HOLD_MM2 * float(centre[2])
    area = float(
        -cross[:, 2].sum() / 2.0 + EDGE_MM * np.linalg.norm(along, axis=1).sum() + HOLD_MM2 * (not held)
    )
    size = np.ptp(placed.mesh.vertices, axis=0)
    return OrientationFigures(
        height_mm=float(size[2]),
        box_mm=(float(size[0]), float(size[1]), float(size[2])),
        overhang_mm2=float(np.linalg.norm(cross, axis=1).sum() / 2.0),
        shadow_mm3=shadow,
        edges_mm=float(np.linalg.norm(along, axis=1).sum()),
        tips=len(found.tips),
        hold_mm3=hold,
        estimate=float(support_estimate(np.array(area), np.array(shadow + EDGE_MM * below + hold))),
        contact_mm2=_contact(whole, lift + rules.plate_mm),
        tipping_deg=tipping,
    )


def overhang_mesh(part: Part, rotation: Floats, rules: SupportRules, lift: float) -> Mesh:
    """Return the faces of a part in an orientation that need support; parameters as of `measure_orientation`."""
    own = overhangs_of(stood(part, rotation, lift), rules)
    used, corners = np.unique(own.mesh.triangles[own.overhangs.faces], return_inverse=True)
    return Mesh(own.mesh.vertices[used], corners.reshape(-1, 3))


def touched_area(
    part: Part, rotation: Floats, rules: SupportRules, lift: float, names: Sequence[str]
) -> float:
    """Return the area (mm2) of the faces named that need support or are on the plate.

    Parameters
    ----------
    part, rotation, rules, lift
        As in `measure_orientation`.
    names
        Names of faces, as in `amprep.model.orientation.OrientationRules`.
    """
    if not names:
        return 0.0
    own = overhangs_of(stood(part, rotation, lift), rules)
    mesh = own.mesh
    touched = np.zeros(len(mesh.triangles), np.bool_)
    touched[own.overhangs.faces] = True
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    touched |= (cross[:, 2] < 0.0) & (corners[:, :, 2].max(axis=1) <= lift + rules.plate_mm)
    as_drawn = Mesh((mesh.vertices - stood(part, rotation, lift).matrix[:3, 3]) @ rotation, mesh.triangles)
    named = np.any([faces_named(part, as_drawn, name) for name in names], axis=0)
    return float(np.linalg.norm(cross[touched & named], axis=1).sum() / 2.0)


def _contact(corners: Floats, height: float) -> float:
    """Return the area of the downward triangles ``(m, 3, 3)`` that are no higher than `height` mm."""
    flat = corners[corners[:, :, 2].max(axis=1) <= height]
    normal = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    return float(np.linalg.norm(normal[normal[:, 2] < 0.0], axis=1).sum() / 2.0)
