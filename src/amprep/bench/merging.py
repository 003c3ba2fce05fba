"""Measure how fast cells are united to one mesh, and compare a sample with manifold3d's batch union."""

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Floats, Ints, MeshArrays
from amprep.bench.memory import peak_mb
from amprep.geometry.merging.merge_cells import unite_cells
from amprep.geometry.merging.voxel_contents import ContentsTable
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import edges_match
from amprep.testing.random_lattice import CellLayout, barrel, random_layout

if TYPE_CHECKING:
    from manifold3d import Manifold

SIZE = np.array([2.0, 2.0, 2.0])
"""Cell size (mm)."""


@dataclass(frozen=True)
class MergingResult:
    """Time, size and validity of one run.

    Attributes
    ----------
    cells, triangles
        Number of cells, and of triangles of each.
    junction_fraction
        Fraction of the cells that share a voxel with another cell.
    seconds, peak_mb
        Time to unite all cells, after a warm-up run; peak memory of the process (MiB).
    merged_triangles
        Number of triangles of the united mesh.
    sample, sample_seconds, rival_seconds
        Number of cells that manifold3d united as well, our time for them, and the time of its batch union.
    time_ratio
        Time per cell of the batch union over our time per cell for all cells.
    volume_error
        Relative difference between the two volumes of the sample.
    genus, rival_genus
        Genus of our mesh of the sample, and of the batch union.
    validated
        True if the mesh of all cells is closed and the sample agrees with the batch union: the volume within
        1e-6, and the genus.
    """

    cells: int
    triangles: int
    junction_fraction: float
    seconds: float
    peak_mb: int | None
    merged_triangles: int
    sample: int
    sample_seconds: float
    rival_seconds: float
    time_ratio: float
    volume_error: float
    genus: int
    rival_genus: int
    validated: bool

    @property
    def line(self) -> str:
        """The result in one line."""
        peak = "" if self.peak_mb is None else f", peak memory {self.peak_mb} MB"
        return (
            f"{self.cells} cells of {self.triangles} triangles, {self.junction_fraction:.0%} at junctions: "
            f"{self.seconds:.2f} s{peak}; sample of {self.sample} cells: {self.sample_seconds:.3f} s, batch union "
            f"{self.rival_seconds:.2f} s ({self.time_ratio:.0f} times as long per cell), volume error "
            f"{self.volume_error:.0e}, genus {self.genus} and {self.rival_genus}, "
            f"{'valid' if self.validated else 'INVALID'}"
        )

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        return asdict(self)


def run_merging(cells: int, sample: int, *, oblique: float = 0.12, seed: int = 0) -> MergingResult:
    """Unite random cells and check the mesh; compare a smaller lattice with manifold3d's batch union.

    Parameters
    ----------
    cells
        Number of cells.
    sample
        Number of cells of the smaller lattice.
    oblique
        Fraction of the cells that lead to a neighbouring square.
    seed
        Seed of the lattice.
    """
    cell, few = barrel(), random_layout(min(sample, cells), oblique, seed)
    _unite(cell, few)  # warm-up: compiles and imports
    sample_seconds, (points, triangles) = _unite(cell, few)
    ours = as_manifold(points, triangles)
    rival_seconds, rival = _batch_union(cell, few)
    error = abs(ours.volume() / rival.volume() - 1.0)
    layout = random_layout(cells, oblique, seed)
    seconds, (points, triangles) = _unite(cell, layout)
    peak = peak_mb()
    del points
    return MergingResult(
        cells=cells,
        triangles=len(cell[1]),
        junction_fraction=layout.junctions,
        seconds=seconds,
        peak_mb=peak,
        merged_triangles=len(triangles),
        sample=len(few.square),
        sample_seconds=sample_seconds,
        rival_seconds=rival_seconds,
        time_ratio=rival_seconds / len(few.square) / (seconds / cells),
        volume_error=error,
        genus=ours.genus(),
        rival_genus=rival.genus(),
        validated=error <= 1e-6 and ours.genus() == rival.genus() and edges_match(triangles),
    )


def _unite(cell: MeshArrays, layout: CellLayout) -> tuple[float, tuple[Floats, Ints]]:
    """Return the time and the mesh of our union."""
    start = time.perf_counter()
    template = np.zeros(len(layout.square), np.int64)
    mesh = unite_cells(ContentsTable([cell]), template, layout.square, layout.shift, np.zeros(3), SIZE)
    if mesh is None:
        raise AssertionError("the cells of this benchmark are united without manifold3d")
    return time.perf_counter() - start, mesh


def _batch_union(cell: MeshArrays, layout: CellLayout) -> tuple[float, "Manifold"]:
    """Return the time and the solid of manifold3d's batch union."""
    from manifold3d import Manifold, OpType

    points, triangles = cell
    solids = []
    for square, shift in zip(layout.square, layout.shift, strict=True):
        moved = points + square
        moved[:, :2] += (1.0 - points[:, 2:]) * shift
        solids.append(as_manifold(moved * SIZE, triangles))
    start = time.perf_counter()
    union = Manifold.batch_boolean(solids, OpType.Add)
    union.num_tri()
    return time.perf_counter() - start, union
