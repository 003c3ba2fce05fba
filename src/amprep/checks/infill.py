"""Judge a filled part: closed, unchanged outside the regions, cells inside them, and connected."""

from collections.abc import Sequence

from amprep.checks.supports.bodies import NEGLIGIBLE_VOLUME
from amprep.checks.violation import Violation
from amprep.geometry.merging.union import FILE_STEP, arrays_of, evaluated, union
from amprep.geometry.meshes.components import count_components
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model import Mesh

CLOSED = "filled part is closed"
OUTSIDE = "unchanged outside the region"
CELLS = "cells in the region"
WHOLE = "in one piece"
PROMISES = (CLOSED, OUTSIDE, CELLS, WHOLE)


def check_filled(
    name: str, before: Mesh, regions: Sequence[Mesh], cells: Mesh, after: Mesh, *, dropped: float = 0.0
) -> list[Violation]:
    """Judge a part whose regions were filled with cells, by exact volumes of manifold3d.

    The tolerance is the rounding of coordinates in files: `FILE_STEP` times the area of the surface.

    Parameters
    ----------
    name
        Name of the part in messages.
    before, after
        The part before and after filling.
    regions
        Closed meshes of the regions.
    cells
        One closed mesh of all cells before clipping.
    dropped
        Volume (mm3) of the components of cells that were dropped because nothing held them.
    """
    was, now, grid = (as_manifold(each.vertices, each.triangles) for each in (before, after, cells))
    if not accepted(now) or now.volume() <= 0.0:
        return [Violation(CLOSED, name, f"expected a solid, manifold3d says {now.status().name}")]
    hole = union([as_manifold(each.vertices, each.triangles) for each in regions])
    around, region = evaluated(was - hole), evaluated(was ^ hole)
    allowed = FILE_STEP * (was.surface_area() + now.surface_area()) + NEGLIGIBLE_VOLUME
    found = []
    lost, gained = (around - now).volume(), (now - was).volume()
    if max(lost, gained) > allowed:
        message = f"lost {lost:.4g} mm3 outside the region and gained {gained:.4g} mm3 where the part was not"
        found.append(Violation(OUTSIDE, name, message))
    expected = around.volume() + (region ^ grid).volume() - dropped
    if abs(now.volume() - expected) > allowed:
        message = f"expected {expected:.6g} mm3 of part and cells, found {now.volume():.6g} mm3"
        found.append(Violation(CELLS, name, message))
    pieces, most = count_components(*arrays_of(now)), max(count_components(*arrays_of(was)), 1)
    if pieces > most:
        message = f"expected {most} components, found {pieces}; the cells do not hold the part together"
        found.append(Violation(WHOLE, name, message))
    return found
