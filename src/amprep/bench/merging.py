"""Times how cells become one mesh, beside manifold3d's batch union of a sample of them."""

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Floats, Ints, MeshArrays
from amprep.bench.routing.run import peak_mb
from amprep.geometry.merging.merge_cells import unite_cells
from amprep.geometry.merging.voxel_contents import ContentsTable
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import edges_match
from amprep.model import DIRECTIONS

if TYPE_CHECKING:
    from manifold3d import Manifold

SIZE = np.array([2.0, 2.0, 2.0])
"""mm, of the grid's cubes."""

_FILLED = 0.55
"""Share of the grid's cubes in which an upright cell stands."""


@dataclass(frozen=True)
class Merging:
    """What one run took and came to.

    Attributes
    ----------
    cells, triangles, junctions
        How many cells, triangles of each, and which share of the cells meets another one of another direction.
    seconds, peak_mb
        Of merging all, once warm; of the whole process by then.
    merged
        Triangles of the mesh.
    sample, sample_seconds, rival_seconds
        How many cells were given to manifold3d's batch union as well; seconds of both.
    times_ours
        How many times as long the batch union takes per cell as merging all cells does.
    volume_off
        By how much the sample's volumes differ, as a share.
    genus, rival_genus
        Of the sample.
    validated
        Whether the mesh of all cells is closed, and the sample's volume (within 1e-6) and genus are the union's.
    """

    cells: int
    triangles: int
    junctions: float
    seconds: float
    peak_mb: int | None
    merged: int
    sample: int
    sample_seconds: float
    rival_seconds: float
    times_ours: float
    volume_off: float
    genus: int
    rival_genus: int
    validated: bool

    @property
    def line(self) -> str:
        """The result in one line."""
        peak = "" if self.peak_mb is None else f", {self.peak_mb} MB"
        return (
            f"{self.cells} cells of {self.triangles} triangles, {self.junctions:.0%} at junctions: "
            f"{self.seconds:.2f} s{peak}; {self.sample} of them {self.sample_seconds:.3f} s, batch union "
            f"{self.rival_seconds:.2f} s, per cell {self.times_ours:.0f} times as long; volume off by "
            f"{self.volume_off:.0e}, genus {self.genus} and {self.rival_genus}"
        )

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Layout:
    """Cells on a grid: upper squares ``(n, 3)`` x, y, layer, and shifts ``(n, 2)`` to the lower ones."""

    square: Ints
    shift: Ints

    @property
    def junctions(self) -> float:
        """Share of the cells that share a cube of the grid with another one."""
        oblique = np.flatnonzero(self.shift.any(axis=1))
        lower = self.square[oblique] + np.pad(self.shift[oblique], ((0, 0), (0, 1)))
        cell = np.concatenate([np.arange(len(self.square)), oblique])
        _, cube, count = np.unique(
            np.concatenate([self.square, lower]), axis=0, return_inverse=True, return_counts=True
        )
        meets = np.zeros(len(self.square), np.bool_)
        meets[cell[count[cube.reshape(-1)] > 1]] = True
        return float(meets.mean())


def random_layout(cells: int, oblique: float, seed: int) -> Layout:
    """Strew upright cells, and a share of oblique ones, over a cube of squares."""
    rng = np.random.default_rng(seed)
    leaning = int(cells * oblique)
    side = int(np.ceil(np.cbrt((cells - leaning) / _FILLED)))
    place = rng.permutation(side**3)[: cells - leaning]
    upright = np.column_stack([place % side, place // side % side, place // side**2])
    edge = rng.permutation(4 * side**3)[:leaning]
    kind, place = np.divmod(edge, side**3)
    tilted = np.column_stack([place % side, place // side % side, place // side**2])
    towards = np.array(DIRECTIONS, np.int64)[1 + kind][:, ::-1]
    square, shift = (
        np.concatenate([upright, tilted]),
        np.concatenate([np.zeros_like(upright[:, :2]), towards]),
    )
    return Layout(square.astype(np.int64), shift.astype(np.int64))


def barrel(sides: int = 6, rings: int = 17) -> MeshArrays:
    """Return a post with a belly in the unit cube: 200 triangles as it is."""
    height = np.linspace(0.0, 1.0, rings)
    radius = 0.2 + 0.08 * np.sin(np.pi * height) ** 2
    turn = 0.3 + 2.0 * np.pi * np.arange(sides) / sides
    plan = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.concatenate(
        [np.column_stack([0.5 + r * plan, np.full(sides, z)]) for r, z in zip(radius, height, strict=True)]
    )
    ring, i = np.divmod(np.arange(sides * (rings - 1)), sides)
    a, b = ring * sides + i, ring * sides + (i + 1) % sides
    walls = [np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides])]
    fan = np.array([[0, k, k + 1] for k in range(1, sides - 1)])
    return points, np.concatenate([*walls, fan[:, ::-1], fan + sides * (rings - 1)]).astype(np.int64)


def run_merging(cells: int, sample: int, *, oblique: float = 0.12, seed: int = 0) -> Merging:
    """Merge random cells and judge the mesh; a smaller layout goes through manifold3d too.

    Parameters
    ----------
    oblique
        Share of the cells that lead sideways.
    """
    cell, few = barrel(), random_layout(min(sample, cells), oblique, seed)
    _merged(cell, few)  # once for what is compiled or loaded on the way
    sample_seconds, (points, triangles) = _merged(cell, few)
    ours = as_manifold(points, triangles)
    rival_seconds, rival = _united(cell, few)
    off = abs(ours.volume() / rival.volume() - 1.0)
    layout = random_layout(cells, oblique, seed)
    seconds, (points, triangles) = _merged(cell, layout)
    peak, merged = peak_mb(), len(triangles)
    del points
    same = off <= 1e-6 and ours.genus() == rival.genus() and edges_match(triangles)
    times = rival_seconds / len(few.square) / (seconds / cells)
    return Merging(
        cells, len(cell[1]), layout.junctions, seconds, peak, merged, len(few.square), sample_seconds,
        rival_seconds, times, off, ours.genus(), rival.genus(), same,
    )  # fmt: skip


def _merged(cell: MeshArrays, layout: Layout) -> tuple[float, tuple[Floats, Ints]]:
    start = time.perf_counter()
    template = np.zeros(len(layout.square), np.int64)
    mesh = unite_cells(ContentsTable([cell]), template, layout.square, layout.shift, np.zeros(3), SIZE)
    if mesh is None:
        raise AssertionError("these cells join on arrays")
    return time.perf_counter() - start, mesh


def _united(cell: MeshArrays, layout: Layout) -> tuple[float, "Manifold"]:
    from manifold3d import Manifold, OpType

    points, triangles = cell
    solids = []
    for square, shift in zip(layout.square, layout.shift, strict=True):
        moved = points + square
        moved[:, :2] += (1.0 - points[:, 2:]) * shift
        solids.append(as_manifold(moved * SIZE, triangles))
    start = time.perf_counter()
    rival = Manifold.batch_boolean(solids, OpType.Add)
    rival.num_tri()
    return time.perf_counter() - start, rival
