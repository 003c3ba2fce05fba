"""Bounding mesh: the mesh of the part with fewer triangles, which contains the part (thesis 2.5)."""

import numpy as np

from amprep.arrays import MeshArrays
from amprep.checks.volumes import check_volume
from amprep.errors import MeshError
from amprep.geometry.bounding.simplification.simplify_outwards import Cost, SimplifiedMesh, simplify_outwards
from amprep.geometry.bounding.simplification.solids import hull, hull_volume, united, without_overlaps
from amprep.model.bounding_volume import Solid
from amprep.model.control import Stop
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.plugins.volumes.params import BoundingMeshParams


def bounding_mesh(
    part: Part,
    *,
    params: BoundingMeshParams,
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,
) -> Solid:
    """Return a closed mesh of fewer triangles that contains the part.

    The exact judge of bounding volumes confirms it. Should it find a remainder outside, the mesh is united with that of
    the part; should it still object, the mesh of the part is the result.

    Raises
    ------
    MeshError
        If the part is not a solid.
    """
    if not part.is_solid:
        raise MeshError(
            f"part {part.name!r}: the volume maker 'bounding-mesh' needs a solid, but the mesh is open; repair it or "
            "choose the volume maker 'box' for it"
        )
    vertices, triangles = _simplified(part.mesh.arrays, params, stop)
    volume = Solid(Mesh(vertices, triangles))
    if not check_volume(part, volume):
        return volume
    volume = Solid(Mesh(*united((vertices, triangles), part.mesh.arrays)))
    return Solid(part.mesh) if check_volume(part, volume) else volume


def _simplified(mesh: MeshArrays, params: BoundingMeshParams, stop: Stop) -> MeshArrays:
    """Return the simplified mesh, or the simplified convex hull where that is smaller and no distance is given."""
    target = params.target(len(mesh[1]))
    limit = np.inf if params.max_error_mm is None else params.max_error_mm
    cost: Cost = "distance" if params.cost == "distance" else "volume"
    found = simplify_outwards(without_overlaps(mesh), target, max_error=limit, cost=cost, stop=stop)
    if np.isfinite(limit) or _volume(found) <= hull_volume(mesh):
        return found.vertices, found.triangles
    coarse = simplify_outwards(hull(mesh), target, cost=cost, stop=stop)
    best = coarse if _volume(coarse) < _volume(found) else found
    return best.vertices, best.triangles


def _volume(mesh: MeshArrays | SimplifiedMesh) -> float:
    return Mesh(mesh[0], mesh[1]).signed_volume
