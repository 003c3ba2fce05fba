"""Measure how much of a part needs support, and how much blockers and enforcers change that."""

from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Int32s
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import PartOverhangs, overhangs_of


@dataclass(frozen=True)
class OverhangFigures:
    """What of a part needs support.

    Attributes
    ----------
    angle_deg
        Overhang angle: a downward face needs support if its angle to the plate is below it.
    faces_mm2, face_regions
        Area of the faces that need support, and the number of connected regions.
    edges_mm, edge_regions
        Length of the knife edges that need support, and the number of connected ones.
    tips
        Number of tips that need support.
    carried_mm2, carried_regions
        Area of the faces flatter than the overhang angle that the part itself carries, and the number of regions that
        need no support at all.
    steep_mm2
        Area of the other downward faces, which are steep enough or in regions below the smallest area.
    on_plate_mm2
        Area of the faces on the plate.
    enforced_mm2, blocked_mm2
        Area of the faces that enforcers add, and that blockers take away.
    regions
        All regions of overhangs, also those that the part itself carries.
    """

    angle_deg: float
    faces_mm2: float
    face_regions: int
    edges_mm: float
    edge_regions: int
    tips: int
    carried_mm2: float
    carried_regions: int
    steep_mm2: float
    on_plate_mm2: float
    enforced_mm2: float
    blocked_mm2: float
    regions: tuple[OverhangRegion, ...] = ()


def measure_overhangs(placed: PlacedPart, rules: SupportRules) -> OverhangFigures:
    """Return what of a placed part needs support.

    Parameters
    ----------
    placed
        The part in build coordinates; the plate is at z = 0.
    rules
        Overhang angle, smallest area and smallest length; the part's own angle takes precedence.
    """
    found = overhangs_of(placed, rules)
    own = placed.part.overrides.overhang_angle_deg
    regions = found.overhangs.regions
    needed = [region for region in regions if not region.is_self_supporting]
    held = [region for region in regions if region.is_self_supporting and not region.is_noncritical]
    faces = _area(found)
    carried = _face_area(found.mesh, found.overhangs.beside)
    carried += sum(region.measure for region in held if region.feature == "face")
    down, on_plate = _downward(found.mesh, rules.plate_mm if rules.has_limits else CONTACT_TOLERANCE)
    without, enforced = (_with_regions(placed, rules, kinds, faces) for kinds in ((), ("enforcer",)))
    return OverhangFigures(
        angle_deg=rules.overhang_angle_deg if own is None else own,
        faces_mm2=faces,
        face_regions=sum(region.feature == "face" for region in needed),
        edges_mm=sum(region.measure for region in needed if region.feature == "edge"),
        edge_regions=sum(region.feature == "edge" for region in needed),
        tips=sum(region.feature == "tip" for region in needed),
        carried_mm2=carried,
        carried_regions=len(held),
        steep_mm2=max(0.0, down - on_plate - enforced - carried),
        on_plate_mm2=on_plate,
        enforced_mm2=max(0.0, enforced - without),
        blocked_mm2=max(0.0, enforced - faces),
        regions=regions,
    )


def _area(found: PartOverhangs) -> float:
    return _face_area(found.mesh, found.overhangs.faces)


def _face_area(mesh: Mesh, faces: Int32s) -> float:
    a, b, c = (mesh.vertices[mesh.triangles[faces, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _with_regions(placed: PlacedPart, rules: SupportRules, kinds: tuple[str, ...], faces: float) -> float:
    """Return the area that needs support if only regions of these kinds exist; it is `faces` with all regions."""
    chosen = tuple(region for region in placed.part.regions if region.kind in kinds)
    if len(chosen) == len(placed.part.regions):
        return faces
    return _area(overhangs_of(replace(placed, part=replace(placed.part, regions=chosen)), rules))


def _downward(mesh: Mesh, plate: float) -> tuple[float, float]:
    """Return the area of all downward faces, and of those at most `plate` mm above the plate."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area, down = np.linalg.norm(normal, axis=1) / 2.0, normal[:, 2] < 0.0
    flat = down & (corners[:, :, 2].max(axis=1) <= plate)
    return float(area[down].sum()), float(area[flat].sum())
