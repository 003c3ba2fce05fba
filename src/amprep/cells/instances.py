"""What a lattice cell has emitted, sorted out, and the closed meshes of its instances."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Ints, MeshArrays
from amprep.geometry.cells.tiling import Tiles, expand, fills_unit_cube, tile
from amprep.geometry.merging.merge_cells import join_cells
from amprep.geometry.merging.prisms import join_prisms
from amprep.geometry.merging.union import is_solid
from amprep.geometry.merging.voxel_contents import Pieces
from amprep.geometry.meshes.welding import round_as_stored
from amprep.model import DIRECTIONS, CellRequest, Cells, Grid, Mesh, Role, Template


class Emitted(NamedTuple):
    """What the emitter answered, instance by instance.

    Attributes
    ----------
    templates
        As arrays.
    tiles
        ``(n,)`` whether an instance is a sound solid in its edge's prism, the only one there.
    sheet, connector
        ``(n,)`` whether it is a surface; whether its edge is a connector.
    whole
        ``(k,)`` whether a template is the whole cube.
    pieces
        What cells come to where they share a cube, as far as it was needed yet.
    """

    request: CellRequest
    cells: Cells
    templates: tuple[MeshArrays, ...]
    tiles: Bools
    sheet: Bools
    connector: Bools
    whole: Bools
    pieces: Pieces

    def of(self, group: int) -> Bools:
        """Which instances belong to the group."""
        return np.asarray(self.request.group[self.cells.edge] == group)


def sort_out(request: CellRequest, cells: Cells) -> Emitted:
    """Tell what kind of instance each is."""
    templates = tuple(arrays(template.mesh) for template in cells.templates)
    surface = np.array([template.surface for template in cells.templates], np.bool_)
    sound = np.array([_is_tile(template) for template in cells.templates], np.bool_)
    own = np.abs(cells.matrix - request.matrices[cells.edge]).max(axis=(1, 2), initial=0.0) < 1e-6
    sheet = surface[cells.template]
    alone = np.bincount(cells.edge[~sheet], minlength=len(request.plane))[cells.edge] == 1
    connector = request.role[cells.edge] == Role.CONNECTOR
    tiles = sound[cells.template] & own & alone
    whole = np.array([template.mesh.signed_volume > 1.0 - 1e-9 for template in cells.templates], np.bool_)
    return Emitted(request, cells, templates, tiles, sheet, connector, sound & whole, Pieces(templates))


def _is_tile(template: Template) -> bool:
    return (
        not template.surface and fills_unit_cube(template.mesh.vertices) and is_solid(*arrays(template.mesh))
    )


def arrays(mesh: Mesh) -> MeshArrays:
    """Return vertices and triangles as the geometry layer wants them."""
    return mesh.vertices, mesh.triangles.astype(np.int64)


def trunks(
    emitted: Emitted, chosen: Bools, seats: Ints | None = None, seat: float = 0.0
) -> Iterator[MeshArrays]:
    """Yield closed meshes of the chosen instances: one of all that tile, one for each other.

    Parameters
    ----------
    seats, seat
        ``(k, 3)`` squares (plane, y, x) below which plates of `seat` mm go with the cells.
    """
    cells, request = emitted.cells, emitted.request
    tiles = chosen & emitted.tiles
    frame, edge, template = request.frame, cells.edge[tiles], cells.template[tiles].astype(np.int64)
    square = np.column_stack([request.x[edge], request.y[edge], request.plane[edge] - 1]).astype(np.int64)
    shift = np.array(DIRECTIONS, np.int64)[request.direction[edge]][:, ::-1]
    below = np.empty((0, 3), np.int64) if seats is None else seats[:, ::-1].astype(np.int64) - (0, 0, 1)
    size = np.array([frame.pitch, frame.pitch, frame.step])
    if len(edge) and emitted.whole[template].all():
        yield join_prisms(square, shift, frame.origin, size)
        edge, template, square, shift = edge[:0], template[:0], square[:0], shift[:0]
    if len(below):
        lid = emitted.pieces.plate(seat / frame.step)
        template = np.concatenate([template, np.full(len(below), lid)])
        square, shift = np.concatenate([square, below]), np.concatenate([shift, np.zeros_like(below[:, :2])])
    if len(template):
        joined = join_cells(emitted.pieces, template, square, shift, frame.origin, size)
        yield from (
            [(round_as_stored(joined[0]), joined[1])]
            if joined
            else _by_direction(emitted.pieces, template, square, shift, frame)
        )
    for index in np.flatnonzero(chosen & ~emitted.tiles):
        one = np.array([cells.template[index]]), cells.matrix[index : index + 1]
        points, triangles, _ = expand(emitted.templates, *one)
        yield points, triangles


def _by_direction(
    pieces: Pieces, template: Ints, square: Ints, shift: Ints, frame: Grid
) -> Iterator[MeshArrays]:
    """Yield closed meshes of cells that do not join on arrays: one or two a direction."""
    size = np.array([frame.pitch, frame.pitch, frame.step])
    for each in np.unique(shift, axis=0):
        own = (shift == each).all(axis=1)
        matrix = np.zeros((int(own.sum()), 3, 4))
        matrix[:, [0, 1, 2], [0, 1, 2]] = size
        matrix[:, :2, 2] = -each * frame.pitch
        matrix[:, :, 3] = frame.origin + (square[own] + (*each, 0)) * size
        # a run of cells of one direction is a column of tiles, sheared with them
        place = square[own] + np.outer(square[own, 2], (*each, 0))
        yield from tile(pieces.templates, Tiles(template[own], place, matrix))
