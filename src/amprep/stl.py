"""Write binary STL files, for machine software that reads no other format."""

from pathlib import Path

import numpy as np

from amprep.files import replacing
from amprep.model.mesh import Mesh

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = b"amprep, binary STL, mm".ljust(80)


def write_stl(mesh: Mesh, path: Path) -> None:
    """Write a mesh as binary STL; the file appears complete, or not at all, and equal meshes give equal bytes.

    The normal of a triangle without area is 0, 0, 0, as the format requires.

    Raises
    ------
    AmprepError
        If the file cannot be written.
    """
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    facets["corners"] = corners
    with replacing(path) as temporary:
        temporary.write_bytes(_HEADER + len(facets).to_bytes(4, "little") + facets.tobytes())
