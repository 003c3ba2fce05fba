"""Triangle mesh of vertices and triangles."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amprep.arrays import Floats, Ints, MeshArrays, frozen


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """Triangle mesh with shared vertices; normals point out of the solid (right-hand rule).

    Attributes
    ----------
    vertices
        ``(n, 3)`` float64, mm.
    triangles
        ``(m, 3)`` int32, indices into `vertices`, counter-clockwise seen from outside.
    """

    vertices: Floats
    triangles: Ints

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.float64, 3))
        object.__setattr__(self, "triangles", frozen(self.triangles, np.int32, 3))

    def __repr__(self) -> str:
        """Numbers of vertices and triangles."""
        return f"Mesh({len(self.vertices)} vertices, {len(self.triangles)} triangles)"

    @property
    def arrays(self) -> MeshArrays:
        """Vertices, and triangles as int64, as the functions of `amprep.geometry` take them."""
        return self.vertices, self.triangles.astype(np.int64)

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Least and greatest corner, each ``(3,)`` mm."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @cached_property
    def signed_volume(self) -> float:
        """Enclosed volume, mm3; overlaps count repeatedly, and the volume is negative if the mesh is inside out."""
        if not len(self.triangles):
            return 0.0
        corners = self.vertices[self.triangles] - self.vertices[:1]
        return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the geometry as 3MF files store it: float32 coordinates of six decimals, and the triangles."""
        kept = np.round(self.vertices, 6).astype("<f4") + np.float32(0.0)  # adding zero turns -0 into +0
        return hashlib.sha256(kept.tobytes() + self.triangles.astype("<i4").tobytes()).hexdigest()

    def moved(self, matrix: Floats) -> "Mesh":
        """Return the mesh under the ``(4, 4)`` row-major affine `matrix` (column vectors)."""
        return Mesh(self.vertices @ matrix[:3, :3].T + matrix[:3, 3], self.triangles)


def join_meshes(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh with the vertices and triangles of all, in their order; nothing is united."""
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    triangles = [mesh.triangles + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(triangles))
