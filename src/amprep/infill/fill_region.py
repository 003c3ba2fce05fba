"""Fills a region of a part with lattice cells: the same emission as for supports, on a block of upright edges."""

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
class Filled:
    """A part whose region is filled with cells.

    Attributes
    ----------
    mesh
        The part: closed, outside the region as it was.
    cells
        What the cells are before they are trimmed, one closed mesh.
    region
        The part's material that the cells have replaced.
    count
        How many cells there are, trimmed ones included.
    cells_mm3
        Volume of the cells in the region, islands left out.
    islands, islands_mm3
        Pieces of cells that nothing held, and so were dropped.
    genus
        How many handles the part's surfaces have.
    lattice
        The part as solid and beams, where these are wanted; `room` is None, the part as it was cuts the beams.
    """

    mesh: Mesh
    cells: Mesh
    region: Mesh
    count: int
    cells_mm3: float
    islands: int
    islands_mm3: float
    genus: int
    lattice: Lattice | None = None

    @property
    def density(self) -> float:
        """Share of the region that the cells fill."""
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
) -> Filled:
    """Replace the part's material in the regions by cells: (part - regions) + (part ^ regions ^ cells).

    Cells reach at least `overlap` mm beyond the regions, so that they are one with the solid around; there they
    add nothing. Computed as part - (regions - cells): two booleans for all cells, and no two faces that coincide.

    Parameters
    ----------
    part, regions
        Closed meshes in common coordinates, mm.
    emit
        Asks the lattice cell.
    size, height
        mm, of a cell along x and y, and along z (None: as `size`).
    beams
        Whether struts are wanted as beams, too; None leaves it to the cell's parameters.

    Raises
    ------
    MeshError
        When a mesh is no solid.
    JobError
        When the regions do not meet the part, or the cells do not suit.
    PluginError
        When the cell's answer does not fit the request.
    """
    progress(0.0, "cutting the region out")
    solid, hole = _solid(part, "the part"), union([_solid(each, "a region") for each in regions])
    filled = evaluated(solid ^ hole)
    if filled.volume() <= CRUMB:
        raise JobError("the region lies outside the part: nothing of it can be filled with cells")
    region = Mesh(*arrays_of(filled))
    request = block_over(region, size=size, height=height or size, overlap=overlap, part=part)
    progress(0.1, f"emitting {len(request.edges)} cells")
    bare = None if beams is False else beams_of(replace(request, beams=beams), emit)
    cells, count = _welded(request, emit)
    progress(0.4, "trimming the cells")
    points, triangles = finish([evaluated(solid - evaluated(hole - cells))])
    progress(0.8, "looking for loose pieces")
    parted = drop_detached(points, triangles, arrays_of(hole), part.arrays)
    mesh, islands = Mesh(*parted.kept), Mesh(*parted.islands)
    loose = abs(islands.signed_volume) if len(islands.triangles) else 0.0
    around = evaluated(solid - hole)
    lattice = None
    if bare is not None:
        lattice = lattice_of(bare, part, islands, shell=Mesh(*arrays_of(around)), whole=mesh)
    return Filled(
        mesh,
        Mesh(*arrays_of(cells)),
        region,
        count,
        max(mesh.signed_volume - float(around.volume()), 0.0),
        parted.number,
        loose,
        genus_of(*parted.kept),
        lattice,
    )


def meets(part: Mesh, region: Mesh) -> bool:
    """Tell whether a region holds anything of a part; both are solids."""
    (low, high), (part_low, part_high) = region.bounds, part.bounds
    if (low > part_high).any() or (high < part_low).any():
        return False
    return bool((as_manifold(*part.arrays) ^ as_manifold(*region.arrays)).volume() > CRUMB)


def _solid(mesh: Mesh, name: str) -> "Manifold":
    solid = as_manifold(*mesh.arrays)
    if not accepted(solid) or solid.volume() <= 0.0:
        raise MeshError(f"{name} is not a solid: expected a closed mesh, right side out")
    return solid


def _welded(request: CellRequest, emit: Emit) -> tuple["Manifold", int]:
    """Return the cells as one solid, not yet trimmed, and how many edges have one."""
    instances = classify(request, checked(request, emit(request)))
    solids = [as_manifold(*mesh) for mesh in expand_cells(instances, ~instances.sheet)]
    extra = [each for each in instances.cells.extra if not each.surface]
    solids += [as_manifold(*each.mesh.arrays) for each in extra]
    cells = union(solids)
    if cells.volume() <= CRUMB:
        raise JobError("the cell has no solid to fill a region with; walls without thickness cannot")
    return cells, len(np.unique(instances.cells.edge[~instances.sheet])) + len(extra)
