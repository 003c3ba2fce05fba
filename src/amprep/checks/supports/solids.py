"""Make the solid of each mesh, find its components and link its triangles, once for all judges."""

from typing import TYPE_CHECKING

from amprep.arrays import Int64s
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.slicing.contours import SlicedMesh
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import Manifold


class KnownSolids:
    """Solids and components of meshes, each made when it is first needed."""

    def __init__(self) -> None:
        self._known: dict[Mesh, Manifold] = {}
        self._shells: dict[Mesh, tuple[int, Int64s]] = {}
        self._sliced: dict[Mesh, SlicedMesh] = {}

    def of(self, mesh: Mesh) -> "Manifold":
        """Return a mesh as a solid, see `as_manifold`."""
        if mesh not in self._known:
            self._known[mesh] = as_manifold(mesh.vertices, mesh.triangles)
        return self._known[mesh]

    def shells_of(self, mesh: Mesh) -> tuple[int, Int64s]:
        """Return the number of components of a mesh, and that of each triangle, see `label_shells`."""
        if mesh not in self._shells:
            self._shells[mesh] = label_shells(mesh.arrays[1], len(mesh.vertices))
        return self._shells[mesh]

    def sliced(self, mesh: Mesh) -> SlicedMesh:
        """Return a mesh that is ready to be cut by planes."""
        if mesh not in self._sliced:
            self._sliced[mesh] = SlicedMesh(*mesh.arrays)
        return self._sliced[mesh]
