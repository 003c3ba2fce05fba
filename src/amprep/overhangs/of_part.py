"""Find the overhangs of a placed part, with the part's own settings, support blockers and enforcers."""

from typing import NamedTuple

import numpy as np

from amprep.geometry.meshes.decimation import merge_coplanar
from amprep.geometry.overhangs.carried.points import Limits
from amprep.geometry.overhangs.find import find_overhangs
from amprep.geometry.overhangs.joints import join_touching
from amprep.geometry.overhangs.limited import find_limited_overhangs
from amprep.geometry.overhangs.regions import Overhangs
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.blockers import ModifiedMesh, apply_regions

MANY_TRIANGLES = 5000
"""In meshes with more triangles than this, those in one plane are merged before overhangs are looked for."""


class PartOverhangs(NamedTuple):
    """The overhangs of a placed part, and the mesh that their indices refer to.

    The mesh is the part's own mesh in build coordinates. With limits, bodies of it that touch face to face are joined.
    If it has many triangles in common planes, these are merged. Both are left out in a part with marked regions or
    painted triangles, which are given by their triangles. Where the border of
    a blocker or enforcer crosses triangles, these are subdivided, and so are those that a limit divides. Where a limit
    divides a knife edge, the point there is a vertex without triangles.
    """

    mesh: Mesh
    overhangs: Overhangs


def overhangs_of(placed: PlacedPart, rules: SupportRules, *, add_angle_deg: float = 0.0) -> PartOverhangs:
    """Return the overhangs of a placed part: with limits those that the part does not carry, on a finer mesh.

    The part's own overhang angle takes precedence over that of the rules. A part whose supports are switched
    off has no overhangs. Nothing inside a blocker is an overhang; every downward face inside an enforcer is one.

    Parameters
    ----------
    placed
        The part in the build.
    rules
        Overhang angle, smallest area and smallest length.
    add_angle_deg
        Added to the overhang angle, the part's own included.
    """
    own = placed.part.overrides
    angle = rules.overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg
    modified = ModifiedMesh(placed.mesh, None)
    searched = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    if own.supports is not False:
        modified = apply_regions(_planned_mesh(placed, rules), placed.part.regions, placed.matrix)
        searched = modified.mesh
    if rules.has_limits and own.supports is not False:
        return _limited(modified, rules, angle + add_angle_deg)
    overhangs = find_overhangs(
        searched.vertices,
        searched.triangles,
        angle_deg=angle + add_angle_deg,
        min_area=rules.min_area_mm2,
        min_length=rules.min_length_mm,
        modifiers=modified.modifiers,
    )
    return PartOverhangs(modified.mesh, overhangs)


def _planned_mesh(placed: PlacedPart, rules: SupportRules) -> Mesh:
    """Return the mesh of a part for planning.

    With limits, bodies that touch face to face are joined. Triangles in one plane are merged if that halves their
    number.
    """
    mesh, part = placed.mesh, placed.part
    if part.regions or part.appearance.triangle_colours is not None:
        return mesh
    joined = join_touching(mesh.vertices, mesh.triangles) if rules.has_limits else None
    mesh = mesh if joined is None else Mesh(*joined)
    if len(mesh.triangles) <= MANY_TRIANGLES:
        return mesh
    merged = merge_coplanar(mesh.vertices, mesh.triangles)
    return mesh if merged is None or 2 * len(merged[1]) > len(mesh.triangles) else Mesh(*merged)


def _limited(modified: ModifiedMesh, rules: SupportRules, angle_deg: float) -> PartOverhangs:
    """Return the overhangs that the part does not carry."""
    mesh = modified.mesh
    found = find_limited_overhangs(
        mesh.vertices,
        mesh.triangles,
        Limits(angle_deg, rules.ledge_mm, rules.bridge_mm, rules.bore_mm, rules.plate_mm, rules.layer_mm),
        noncritical_deg=rules.noncritical_angle_deg,
        modifiers=modified.modifiers,
    )
    if found.vertices is mesh.vertices:
        return PartOverhangs(mesh, found.overhangs)
    return PartOverhangs(Mesh(found.vertices, found.triangles), found.overhangs)
