"""Classify the instances a cell emitter returned and expand them to closed meshes."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s, Ints, MeshArrays
from amprep.geometry.cells.tiling import Tiles, expand, fills_unit_cube, tile
from amprep.geometry.merging.merge_cells import unite_cells
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

    def with_new_contents(self) -> "CellInstances":
        """Return the same instances without voxel contents, whose shapes depend on what was united before."""
        return self._replace(contents=ContentsTable(self.templates))


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
    cells, request = instances.cells, instances.request
    grid, index = request.grid, np.flatnonzero(chosen & instances.tiles)
    edge, template = cells.edge[index], cells.template[index].astype(np.int64)
    square = request.edges.upper[edge][:, ::-1].astype(np.int64) - (0, 0, 1)
    shift = np.array(DIRECTIONS, np.int64)[request.edges.direction[edge]][:, ::-1]
    if len(edge) and instances.whole[template].all():
        yield unite_prisms(square, shift, grid.origin, _voxel_size(grid))
        template, square, shift = template[:0], square[:0], shift[:0]
    if plates is not None and len(plates):
        below = plates[:, ::-1].astype(np.int64) - (0, 0, 1)
        plate = instances.contents.plate(thickness / grid.step)
        template = np.concatenate([template, np.full(len(below), plate)])
        square, shift = np.concatenate([square, below]), np.concatenate([shift, np.zeros_like(below[:, :2])])
    if len(template):
        yield from _united(instances.contents, template, square, shift, grid)
    for other in np.flatnonzero(chosen & ~instances.tiles):
        one = np.array([cells.template[other]]), cells.matrix[other : other + 1]
        points, triangles, _ = expand(instances.templates, *one)
        yield points, triangles


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
