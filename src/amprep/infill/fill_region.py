"""Replace regions of a part by lattice cells, which are emitted as for supports on a block of vertical edges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from amprep.cells.answers import Emit, checked
from amprep.cells.instances import classify, expand_cells
from amprep.errors import JobError, MeshError
from amprep.geometry.merging.union import arrays_of, evaluated, finish, union
from amprep.geometry.meshes.components import CRUMB, drop_detached, genus_of
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.infill.beams import beams_of, lattice_of
from amprep.infill.block import block_over
from amprep.model import CellRequest, Lattice, Mesh, Progress, silent

if TYPE_CHECKING:
    from manifold3d import Manifold


@dataclass(frozen=True, eq=False)
class FilledPart:
    """A part whose regions are filled with cells.

    Attributes
    ----------
    mesh
        The filled part, closed and unchanged outside the regions.
    cells
        All cells before clipping, one closed mesh.
    region
        The material of the part that the cells have replaced.
    count
        Number of cells, clipped ones included.
    cells_mm3
        Volume of the cells in the regions, without dropped components.
    dropped_components, dropped_volume_mm3
        Number and volume of the components of cells that nothing held and that were dropped.
    genus
        Genus of the surfaces of the part.
    lattice
        The part as a solid and beams, if beams are wanted; its `room` is None, because the part before filling clips
        the beams.
    """

    mesh: Mesh
    cells: Mesh
    region: Mesh
    count: int
    cells_mm3: float
    dropped_components: int
    dropped_volume_mm3: float
    genus: int
    lattice: Lattice | None = None

    @property
    def density(self) -> float:
        """Fraction of the volume of the regions that the cells fill."""
        return self.cells_mm3 / max(abs(self.region.signed_volume), CRUMB)


def fill_region(
    part: Mesh,
    regions: Sequence[Mesh],
    emit: Emit,
    *,
    size: float,
    height: float | None = None,
    overlap: float = 0.1,
    beams: bool | None = False,
    progress: Progress = silent,
) -> FilledPart:
    """Replace the material of a part in the regions by cells: (part - regions) + (part ^ regions ^ cells).

    Cells extend beyond the regions, so that they are united with the solid around them, to which they add nothing. The
    result is computed as part - (regions - cells), which takes two Booleans and has no coincident faces.

    Parameters
    ----------
    part, regions
        Closed meshes in common coordinates, mm.
    emit
        Calls the lattice cell.
    size, height
        Size of a cell along x and y, and along z (None: the same as `size`), mm.
    overlap
        Length (mm) by which cells extend beyond the regions at least.
    beams
        Whether struts are also returned as beams; None leaves it to the parameters of the cell.
    progress
        Callback for progress.

    Raises
    ------
    MeshError
        When a mesh is not a solid.
    JobError
        When the regions do not meet the part, or the cell cannot fill them.
    PluginError
        When the answer of the cell does not fit the request.
    """
    progress(0.0, "subtracting the region")
    solid, hole = _solid(part, "the part"), union([_solid(each, "a region") for each in regions])
    filled = evaluated(solid ^ hole)
    if filled.volume() <= CRUMB:
        raise JobError("the region is outside the part, so it cannot be filled with cells")
    region = Mesh(*arrays_of(filled))
    request = block_over(region, size=size, height=height or size, overlap=overlap, part=part)
    progress(0.1, f"emitting {len(request.edges)} cells")
    struts = None if beams is False else beams_of(replace(request, beams=beams), emit)
    cells, count = _united_cells(request, emit)
    progress(0.4, "clipping the cells")
    points, triangles = finish([evaluated(solid - evaluated(hole - cells))])
    progress(0.8, "finding disconnected components")
    split = drop_detached(points, triangles, arrays_of(hole), part.arrays)
    mesh, dropped = Mesh(*split.kept), Mesh(*split.detached)
    dropped_volume_mm3 = abs(dropped.signed_volume) if len(dropped.triangles) else 0.0
    around = evaluated(solid - hole)
    lattice = None
    if struts is not None:
        lattice = lattice_of(struts, part, dropped, shell=Mesh(*arrays_of(around)), whole=mesh)
    return FilledPart(
        mesh,
        Mesh(*arrays_of(cells)),
        region,
        count,
        max(mesh.signed_volume - float(around.volume()), 0.0),
        split.components,
        dropped_volume_mm3,
        genus_of(*split.kept),
        lattice,
    )


def meets(part: Mesh, region: Mesh) -> bool:
    """Tell whether a region and a part, both solids, have a volume in common."""
    (low, high), (part_low, part_high) = region.bounds, part.bounds
    if (low > part_high).any() or (high < part_low).any():
        return False
    return bool((as_manifold(*part.arrays) ^ as_manifold(*region.arrays)).volume() > CRUMB)


def _solid(mesh: Mesh, name: str) -> "Manifold":
    solid = as_manifold(*mesh.arrays)
    if not accepted(solid) or solid.volume() <= 0.0:
        raise MeshError(f"{name} is not a solid: expected a closed mesh with outward normals")
    return solid


def _united_cells(request: CellRequest, emit: Emit) -> tuple["Manifold", int]:
    """Return the cells as one solid before clipping, and the number of edges with a cell."""
    instances = classify(request, checked(request, emit(request)))
    solids = [as_manifold(*mesh) for mesh in expand_cells(instances, ~instances.sheet)]
    extra = [each for each in instances.cells.extra if not each.surface]
    solids += [as_manifold(*each.mesh.arrays) for each in extra]
    cells = union(solids)
    if cells.volume() <= CRUMB:
        raise JobError(
            "the cell has no solid; walls without thickness cannot fill a region; choose another by --cell"
        )
    return cells, len(np.unique(instances.cells.edge[~instances.sheet])) + len(extra)
