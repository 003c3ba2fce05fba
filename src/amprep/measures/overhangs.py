"""Measure how much of a part needs support, and how much blockers and enforcers change that."""

from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE
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
    steep_mm2
        Area of the other downward faces, which are steep enough or in regions below the smallest area.
    on_plate_mm2
        Area of the faces on the plate.
    enforced_mm2, blocked_mm2
        Area of the faces that enforcers add, and that blockers take away.
    """

    angle_deg: float
    faces_mm2: float
    face_regions: int
    edges_mm: float
    edge_regions: int
    tips: int
    steep_mm2: float
    on_plate_mm2: float
    enforced_mm2: float
    blocked_mm2: float


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
    faces = _area(found)
    down, on_plate = _downward(found.mesh)
    without, enforced = (_with_regions(placed, rules, kinds) for kinds in ((), ("enforcer",)))
    return OverhangFigures(
        angle_deg=rules.overhang_angle_deg if own is None else own,
        faces_mm2=faces,
        face_regions=sum(region.kind == "face" for region in regions),
        edges_mm=sum(region.measure for region in regions if region.kind == "edge"),
        edge_regions=sum(region.kind == "edge" for region in regions),
        tips=sum(region.kind == "tip" for region in regions),
        steep_mm2=max(0.0, down - on_plate - enforced),
        on_plate_mm2=on_plate,
        enforced_mm2=max(0.0, enforced - without),
        blocked_mm2=max(0.0, enforced - faces),
    )


def _area(found: PartOverhangs) -> float:
    return sum(region.measure for region in found.overhangs.regions if region.kind == "face")


def _with_regions(placed: PlacedPart, rules: SupportRules, kinds: tuple[str, ...]) -> float:
    """Return the area that needs support if only regions of these kinds exist."""
    chosen = tuple(region for region in placed.part.regions if region.kind in kinds)
    return _area(overhangs_of(replace(placed, part=replace(placed.part, regions=chosen)), rules))


def _downward(mesh: Mesh) -> tuple[float, float]:
    """Return the area of all downward faces, and of those on the plate."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area, down = np.linalg.norm(normal, axis=1) / 2.0, normal[:, 2] < 0.0
    flat = down & (corners[:, :, 2].max(axis=1) <= CONTACT_TOLERANCE)
    return float(area[down].sum()), float(area[flat].sum())
