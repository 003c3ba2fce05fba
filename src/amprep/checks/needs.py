"""What of each placed part needs support: overhangs, the part's own settings, blockers and enforcers."""

from collections.abc import Iterable

import numpy as np

from amprep.geometry.inside import inside
from amprep.geometry.overhangs import Marks, Overhangs, find_overhangs
from amprep.model.arrays import Bools, Floats
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.part import Part, Region


def needs_of(
    placed: PlacedPart,
    mesh: Mesh,
    *,
    overhang_angle_deg: float,
    least_area: float,
    least_length: float,
    grant_deg: float = 0.0,
) -> Overhangs:
    """Return what needs support of a part that stands in the build as `mesh`.

    The part's own overhang angle comes before the job's; a part with supports switched off needs none. A
    region marks its triangles, or the triangles whose centre and the vertices that lie inside its mesh. Both
    angles are lowered by `grant_deg`.
    """
    own = placed.part.overrides
    if own.supports is False:
        mesh = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    return find_overhangs(
        mesh.vertices,
        mesh.triangles,
        angle_deg=(overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg)
        - grant_deg,
        least_area=least_area,
        least_length=least_length,
        marks=_marks(placed.part) if own.supports is not False else None,
    )


def _marks(part: Part) -> Marks | None:
    blockers = [region for region in part.regions if region.kind == "blocker"]
    enforcers = [region for region in part.regions if region.kind == "enforcer"]
    if not blockers and not enforcers:
        return None
    centres = part.mesh.vertices[part.mesh.triangles].mean(axis=1)
    blocked = _marked_triangles(blockers, centres)
    vertices = _in_meshes(blockers, part.mesh.vertices)
    vertices |= np.isin(np.arange(len(vertices)), part.mesh.triangles[blocked])
    return Marks(_marked_triangles(enforcers, centres), blocked, vertices)


def _marked_triangles(regions: Iterable[Region], centres: Floats) -> Bools:
    regions = tuple(regions)
    marked = _in_meshes(regions, centres)
    for region in regions:
        if region.triangles is not None:
            marked[region.triangles] = True
    return marked


def _in_meshes(regions: Iterable[Region], points: Floats) -> Bools:
    found = np.zeros(len(points), np.bool_)
    for region in regions:
        if region.mesh is not None:
            found |= inside(points, region.mesh.vertices, region.mesh.triangles)
    return found
