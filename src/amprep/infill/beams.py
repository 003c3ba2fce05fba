"""Write the struts of a filled region as beams, clipped by the part, beside the rest of its solid."""

import numpy as np

from amprep.cells.answers import Emit, checked
from amprep.errors import JobError
from amprep.geometry.meshes.containment import inside
from amprep.geometry.supports.beams import near_surface, sample
from amprep.model import Beams, CellRequest, Lattice, Mesh
from amprep.model.build import MAX_STAND_IN_TRIANGLES


def beams_of(request: CellRequest, emit: Emit) -> Beams | None:
    """Return the struts of a cell as beams; None when the cell has other shapes and beams are not required.

    Raises
    ------
    JobError
        When beams are required and the cell does not consist of struts only.
    """
    cells = checked(request, emit(request))
    if cells.beams is not None and len(cells.beams.struts) and not len(cells.template) and not cells.extra:
        return cells.beams
    if request.beams:
        raise JobError(
            "the cell does not consist of struts only, so it cannot be written as beams; use --lattice mesh"
        )
    return None


def lattice_of(beams: Beams, part: Mesh, dropped: Mesh, *, shell: Mesh, whole: Mesh) -> Lattice:
    """Return the shell with all beams that meet the part and do not belong to a dropped component.

    Readers without beams use the whole part, or the part before filling if the whole has very many triangles.

    Parameters
    ----------
    beams
        Struts of all cells.
    part
        The part before filling, which clips the beams.
    dropped
        Components that were dropped.
    shell
        The part without the region.
    whole
        The part with all cells as solids.
    """
    places = sample(beams.nodes, beams.struts.astype(np.int64), beams.radii)
    vertices, triangles = part.arrays
    meets = inside(places.centres, vertices, part.triangles)
    meets |= near_surface(places.centres, float(places.radii.max()), vertices, triangles)
    kept = np.bincount(places.strut[meets], minlength=len(beams.struts)) > 0
    if len(dropped.triangles):
        kept[places.strut[inside(places.centres, dropped.vertices, dropped.triangles)]] = False
    used, local = np.unique(beams.struts[kept], return_inverse=True)
    struts = local.reshape(-1, 2).astype(np.int32)
    nodes, radii = np.round(beams.nodes[used], 6), np.round(beams.radii[kept], 6)
    stand_in = whole if len(whole.triangles) <= MAX_STAND_IN_TRIANGLES else part
    return Lattice(nodes, struts, radii, shell, stand_in, None)
