"""Classify the instances a cell emitter returned and expand them to closed meshes."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s, Ints, MeshArrays
from amprep.geometry.cells.tiling import Tiles, expand, fills_unit_cube, tile
from amprep.geometry.merging.merge_cells import fill_voxels, unite_cells
from amprep.geometry.merging.prisms import unite_prisms
from amprep.geometry.merging.union import is_solid
from amprep.geometry.merging.voxel_contents import ContentsTable
from amprep.geometry.meshes.welding import round_as_stored
from amprep.model import DIRECTIONS, CellRequest, Cells, Grid, Role, Template


class CellInstances(NamedTuple):
    """Classified answer of a cell emitter. An instance is a template under the map of an edge.

    Attributes
    ----------
    templates
        Meshes of the templates as arrays.
    tiles
        ``(n,)`` whether an instance is a valid solid in the prism of its edge, and the only solid of that edge.
    sheet, connector
        ``(n,)`` whether an instance is a surface, and whether its edge is a connector.
    whole
        ``(k,)`` whether a template is the whole unit cube.
    contents
        Voxel contents that were united so far.
    """

    request: CellRequest
    cells: Cells
    templates: tuple[MeshArrays, ...]
    tiles: Bools
    sheet: Bools
    connector: Bools
    whole: Bools
    contents: ContentsTable

    def of(self, group: int) -> Bools:
        """Tell which instances belong to a support group."""
        return np.asarray(self.request.edges.group[self.cells.edge] == group)

    def with_own_contents(self) -> "CellInstances":
        """Return the same instances with a copy of the voxel contents: what is added there is not seen elsewhere.

        The shapes of contents depend on what was united before, to a few lattice steps.
        """
        return self._replace(contents=self.contents.copy())


def classify(request: CellRequest, cells: Cells) -> CellInstances:
    """Classify every instance of an answer."""
    templates = tuple(template.mesh.arrays for template in cells.templates)
    surface = np.array([template.surface for template in cells.templates], np.bool_)
    valid = np.array([_is_tile(template) for template in cells.templates], np.bool_)
    own_map = np.abs(cells.matrix - request.matrices[cells.edge]).max(axis=(1, 2), initial=0.0) < 1e-6
    sheet = surface[cells.template]
    alone = np.bincount(cells.edge[~sheet], minlength=len(request.edges))[cells.edge] == 1
    connector = request.role[cells.edge] == Role.CONNECTOR
    tiles = valid[cells.template] & own_map & alone
    whole = np.array([template.mesh.signed_volume > 1.0 - 1e-9 for template in cells.templates], np.bool_)
    return CellInstances(
        request, cells, templates, tiles, sheet, connector, valid & whole, ContentsTable(templates)
    )


def _is_tile(template: Template) -> bool:
    mesh = template.mesh
    return not template.surface and fills_unit_cube(mesh.vertices) and is_solid(*mesh.arrays)


def expand_cells(
    instances: CellInstances, chosen: Bools, plates: Ints | None = None, thickness: float = 0.0
) -> Iterator[MeshArrays]:
    """Yield closed meshes of the chosen instances: one mesh of all tiles, and one of each other instance.

    Parameters
    ----------
    chosen
        ``(n,)`` instances to expand.
    plates
        ``(k, 3)`` squares (plane, y, x). A plate below each of them becomes part of the first mesh.
    thickness
        Thickness of the plates, mm.
    """
    cells, grid = instances.cells, instances.request.grid
    template, square, shift = tiles = _tiles(instances, chosen)
    if instances.whole[template].all() and len(template):
        yield unite_prisms(square, shift, grid.origin, _voxel_size(grid))
        tiles = _CellTiles(template[:0], square[:0], shift[:0])
    tiles = tiles.with_plates(instances.contents, plates, thickness / grid.step)
    if len(tiles.template):
        yield from _united(instances.contents, *tiles, grid)
    for other in np.flatnonzero(chosen & ~instances.tiles):
        one = np.array([cells.template[other]]), cells.matrix[other : other + 1]
        points, triangles, _ = expand(instances.templates, *one)
        yield points, triangles


def unite_contents(
    instances: CellInstances, chosen: Bools, plates: Ints | None = None, thickness: float = 0.0
) -> None:
    """Unite the voxel contents that `expand_cells` uses with the same arguments, and keep them."""
    tiles, grid = _tiles(instances, chosen), instances.request.grid
    if not instances.whole[tiles.template].all():
        tiles = tiles.with_plates(instances.contents, plates, thickness / grid.step)
        fill_voxels(instances.contents, *tiles)


class _CellTiles(NamedTuple):
    """Cells that are tiles: template ``(n,)``, upper square ``(n, 3)`` x, y, layer, and shift to the lower one."""

    template: Int64s
    square: Int64s
    shift: Int64s

    def with_plates(self, contents: ContentsTable, squares: Ints | None, thickness: float) -> "_CellTiles":
        """Return the tiles with a plate below each square ``(k, 3)`` plane, y, x; the thickness is in layers."""
        if squares is None or not len(squares):
            return self
        below = squares[:, ::-1].astype(np.int64) - (0, 0, 1)
        plate = np.full(len(below), contents.plate(thickness))
        return _CellTiles(
            np.concatenate([self.template, plate]),
            np.concatenate([self.square, below]),
            np.concatenate([self.shift, np.zeros_like(below[:, :2])]),
        )


def _tiles(instances: CellInstances, chosen: Bools) -> _CellTiles:
    """Return the chosen instances that are tiles."""
    cells, edges, index = instances.cells, instances.request.edges, np.flatnonzero(chosen & instances.tiles)
    edge = cells.edge[index]
    square = edges.upper[edge][:, ::-1].astype(np.int64) - (0, 0, 1)
    shift = np.array(DIRECTIONS, np.int64)[edges.direction[edge]][:, ::-1]
    return _CellTiles(cells.template[index].astype(np.int64), square, shift)


def _voxel_size(grid: Grid) -> np.ndarray:
    return np.array([grid.pitch, grid.pitch, grid.step])


def _united(
    contents: ContentsTable, template: Int64s, square: Int64s, shift: Int64s, grid: Grid
) -> Iterator[MeshArrays]:
    """Yield the union of cells as one closed mesh; where the array union fails, one or two meshes a direction."""
    size = _voxel_size(grid)
    united = unite_cells(contents, template, square, shift, grid.origin, size)
    if united is not None:
        yield round_as_stored(united[0]), united[1]
        return
    for each in np.unique(shift, axis=0):
        own = (shift == each).all(axis=1)
        matrix = np.zeros((int(own.sum()), 3, 4))
        matrix[:, [0, 1, 2], [0, 1, 2]] = size
        matrix[:, :2, 2] = -each * grid.pitch
        matrix[:, :, 3] = grid.origin + (square[own] + (*each, 0)) * size
        # consecutive cells of one direction form a column of tiles under the same shear
        place = square[own] + np.outer(square[own, 2], (*each, 0))
        yield from tile(contents.templates, Tiles(template[own], place, matrix))
