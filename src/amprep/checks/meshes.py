"""Check the mesh reader's promise: valid triangles, outward orientation, and the volume of the record."""

import numpy as np

from amprep.checks.violation import Violation
from amprep.geometry.meshes.repair import find_defect, repair_mesh
from amprep.model.part import Part


def check_part(part: Part) -> list[Violation]:
    """Return the violations of the mesh reader's promise.

    The mesh must be finite, not empty, and its indices in range. If `is_solid`, manifold3d must accept it
    unchanged, no shell may be inside out, and `volume_mm3` must be the volume where the winding number is
    positive. The quantity must be at least 1, and the triangles of regions and colours must exist.
    """
    vertices, triangles = part.mesh.vertices, part.mesh.triangles
    defect = find_defect(vertices, triangles)
    if defect:
        return [Violation("mesh", part.name, f"expected finite triangles; {defect}")]
    found = _check_records(part)
    if not part.is_solid:
        return found
    repaired = repair_mesh(vertices, triangles)
    if repaired.problem:
        return [*found, Violation("solid", part.name, f"expected a solid; {repaired.problem}")]
    if repaired.turned.any():
        found.append(Violation("orientation", part.name, f"expected outward normals; {repaired.notes[-1]}"))
    if not np.isclose(part.volume_mm3, repaired.volume, rtol=1e-6):
        message = f"expected {repaired.volume:.6g} mm3, found {part.volume_mm3:.6g} mm3 in the record"
        found.append(Violation("volume", part.name, message))
    return found


def _check_records(part: Part) -> list[Violation]:
    count = len(part.mesh.triangles)
    found = []
    if part.quantity < 1:
        found.append(Violation("quantity", part.name, f"expected at least 1, found {part.quantity}"))
    for region in part.regions:
        chosen = region.triangles
        if chosen is not None and len(chosen) and not 0 <= chosen.min() <= chosen.max() < count:
            message = f"region {region.name!r}: expected triangles 0 to {count - 1}, found others outside this range"
            found.append(Violation("regions", part.name, message))
    colours = part.appearance.triangle_colours
    if colours is not None and np.shape(colours) != (count, 3):
        message = f"expected 3 colours for each of {count} triangles, found shape {np.shape(colours)}"
        found.append(Violation("colours", part.name, message))
    return found
