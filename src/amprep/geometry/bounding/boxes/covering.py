"""Cover a mesh with few boxes: branch and cut on cells, then boxes that fit the mesh exactly (thesis 2.3)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.geometry.bounding.boxes.branch_and_cut import CellCover, cover_cells
from amprep.geometry.bounding.boxes.cells import CellGrid, cells_of, in_mm, required_cells, snapped
from amprep.geometry.bounding.boxes.fit import merged, shrink
from amprep.geometry.bounding.boxes.improve import improve
from amprep.geometry.bounding.boxes.k_means import cluster_boxes
from amprep.geometry.bounding.boxes.polygons import ConvexPolygons, boxes_as_polygons, polygons_of
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch, flat_coordinates
from amprep.geometry.bounding.boxes.union import union_volume

_FINE = 32
"""Cells along the longest side in which the surface is enclosed for k-means and for the improvement."""

_RESTARTS = 16

_SEARCH = TwoBoxSearch(planes=20, rounds=2, starts=1)

_EXACT = 60_000
"""Triangles times passes of the improvement on triangles."""


class CoverSearch(NamedTuple):
    """Settings of `cover_mesh`.

    Attributes
    ----------
    boxes
        Greatest number of boxes, 2 to 4.
    cells
        Cells along the longest side of the mesh.
    work
        Millions of steps of branch and cut.
    """

    boxes: int = 3
    cells: int = 16
    work: float = 0.6


class BoxCover(NamedTuple):
    """A covering of a mesh, and what is known about coverings of its cells.

    Attributes
    ----------
    boxes
        ``(k, 6)`` mm; they contain the mesh, and its interior.
    volume
        Volume of their union, mm3.
    cells_volume
        Volume of the best known covering of the cells by blocks of cells, mm3.
    bound
        No covering of the cells with as many blocks of cells has less volume, mm3.
    """

    boxes: Floats
    volume: float
    cells_volume: float
    bound: float

    @property
    def gap(self) -> float:
        """How far the bound is below the best covering of the cells, as a fraction of it; 0 if it is proven optimal."""
        return 1.0 - self.bound / self.cells_volume if self.cells_volume > 0 else 0.0


def cover_mesh(
    vertices: Floats,
    triangles: Ints,
    search: CoverSearch,
    *,
    rng: np.random.Generator,
    stop: Callable[[], bool],
) -> BoxCover:
    """Cover a mesh with at most `search.boxes` boxes of small union.

    Strategy: k-means gives a first covering, which bounds branch and cut from above. Both coverings are shrunk to
    the enclosing boxes of the surface in fine cells and improved two boxes at a time; the better one is improved on
    the triangles, so that the grid leaves no trace.
    """
    polygons = polygons_of(vertices, triangles)
    flat = flat_coordinates(vertices, triangles)
    items = cells_of(vertices, triangles, _FINE).items
    rough = boxes_as_polygons(items)
    _, start = cluster_boxes(items, search.boxes, _RESTARTS, rng)
    coverings = [improve(rough, start, search.boxes, _SEARCH, preferred=flat, passes=2, stop=stop)]
    grid = cells_of(vertices, triangles, search.cells)
    found = _on_cells(grid, coverings[0], search, stop)
    if len(found.blocks):
        blocks = in_mm(grid, found.blocks)
        coverings.append(improve(rough, blocks, search.boxes, _SEARCH, preferred=flat, passes=2, stop=stop))
    best = min(coverings, key=union_volume)
    best = _on_triangles(polygons, best, search.boxes, flat, stop)
    cell = float(np.prod(grid.size))
    return BoxCover(best, union_volume(best), found.cells * cell, found.bound * cell)


def _on_cells(grid: CellGrid, boxes: Floats, search: CoverSearch, stop: Callable[[], bool]) -> CellCover:
    required = required_cells(grid.met, search.boxes)
    covered = required.copy()
    for x0, y0, z0, x1, y1, z1 in snapped(grid, boxes).tolist():
        covered[x0:x1, y0:y1, z0:z1] = True
    limit = int(covered.sum())
    return cover_cells(required, search.boxes, limit=limit, work=search.work, stop=stop)


def _on_triangles(
    polygons: ConvexPolygons, boxes: Floats, count: int, flat: Sequence[Floats], stop: Callable[[], bool]
) -> Floats:
    passes = min(_EXACT // len(polygons.first), 4)
    if not passes:
        return merged(polygons, shrink(polygons, boxes))
    better = improve(polygons, boxes, count, _SEARCH, preferred=flat, passes=passes, stop=stop)
    return merged(polygons, better)
