"""Make the solid of each mesh once for all judges."""

from typing import TYPE_CHECKING

from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import Manifold


class KnownSolids:
    """Solids of meshes, each made when it is first needed."""

    def __init__(self) -> None:
        self._known: dict[Mesh, Manifold] = {}

    def of(self, mesh: Mesh) -> "Manifold":
        """Return a mesh as a solid, see `as_manifold`."""
        if mesh not in self._known:
            self._known[mesh] = as_manifold(mesh.vertices, mesh.triangles)
        return self._known[mesh]
