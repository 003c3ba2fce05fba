"""The struts of a filled region as beams, cut off by the part, beside the solid that is left of it."""

import numpy as np

from amprep.cells.answers import Emit, checked
from amprep.errors import JobError
from amprep.geometry.meshes.containment import inside
from amprep.geometry.supports.beams import near_surface, sample
from amprep.model import Beams, CellRequest, Lattice, Mesh
from amprep.model.build import MAX_STAND_IN_TRIANGLES


def beams_of(request: CellRequest, emit: Emit) -> Beams | None:
    """Return the struts that a cell makes as beams; None when it makes none, and need not.

    Raises
    ------
    JobError
        When it has to, and is not made of struts alone.
    """
    cells = checked(request, emit(request))
    if cells.beams is not None and len(cells.beams.struts) and not len(cells.template) and not cells.extra:
        return cells.beams
    if request.beams:
        raise JobError(
            "the cell is not made of struts alone, and cannot be written as beams; use --lattice mesh"
        )
    return None


def lattice_of(beams: Beams, part: Mesh, islands: Mesh, *, shell: Mesh, whole: Mesh) -> Lattice:
    """Return the shell with all beams that meet the part, and do not belong to an island.

    Parameters
    ----------
    part
        As it was: what is to cut the beams off.
    islands
        Pieces that were dropped.
    shell, whole
        The part without the region; with all cells as solids, which stands in for the beams in readers that know
        none, or else, where that has very many triangles, the part as it was.
    """
    places = sample(beams.nodes, beams.struts.astype(np.int64), beams.radii)
    vertices, triangles = part.arrays
    meets = inside(places.centres, vertices, part.triangles)
    meets |= near_surface(places.centres, float(places.radii.max()), vertices, triangles)
    kept = np.bincount(places.strut[meets], minlength=len(beams.struts)) > 0
    if len(islands.triangles):
        kept[places.strut[inside(places.centres, islands.vertices, islands.triangles)]] = False
    used, local = np.unique(beams.struts[kept], return_inverse=True)
    struts = local.reshape(-1, 2).astype(np.int32)
    nodes, radii = np.round(beams.nodes[used], 6), np.round(beams.radii[kept], 6)
    stand_in = whole if len(whole.triangles) <= MAX_STAND_IN_TRIANGLES else part
    return Lattice(nodes, struts, radii, shell, stand_in, None)
