"""The cells, seats and connectors of one support group, united to one solid, or put together as sheets."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.geometry.cell_prisms import join_prisms
from amprep.geometry.cell_sheets import join_sheets, plan_segments, raise_sheets
from amprep.geometry.cell_solids import FILE_STEP, finish, is_solid, union
from amprep.geometry.cell_tiling import Arrays, Tiles, expand, fills_unit_cube, plate, tile
from amprep.geometry.connectors import connect
from amprep.geometry.solids import as_manifold
from amprep.model import DIRECTIONS, CellRequest, Cells, GridFrame, Mesh, Role, Template
from amprep.model.arrays import CONTACT_TOLERANCE, Bools, Floats, Ints
from amprep.pipeline.cell_carving import Obstacles, standing_only
from amprep.pipeline.cell_connectors import Ways
from amprep.pipeline.cell_feet import foot_boxes, make_feet
from amprep.pipeline.support_layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold

SEAT = 0.2
"""mm; connectors begin this far below their red square, inside what stands there (at most a quarter step)."""


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
    """

    request: CellRequest
    cells: Cells
    templates: tuple[Arrays, ...]
    tiles: Bools
    sheet: Bools
    connector: Bools
    whole: Bools

    def of(self, group: int) -> Bools:
        """Which instances belong to the group."""
        return np.asarray(self.request.group[self.cells.edge] == group)


def sort_out(request: CellRequest, cells: Cells) -> Emitted:
    """Tell what kind of instance each is."""
    templates = tuple(_arrays(template.mesh) for template in cells.templates)
    surface = np.array([template.surface for template in cells.templates], np.bool_)
    sound = np.array([_is_tile(template) for template in cells.templates], np.bool_)
    own = np.abs(cells.matrix - request.matrices[cells.edge]).max(axis=(1, 2), initial=0.0) < 1e-6
    sheet = surface[cells.template]
    alone = np.bincount(cells.edge[~sheet], minlength=len(request.plane))[cells.edge] == 1
    connector = request.role[cells.edge] == Role.CONNECTOR
    tiles = sound[cells.template] & own & alone
    whole = np.array([template.mesh.signed_volume > 1.0 - 1e-9 for template in cells.templates], np.bool_)
    return Emitted(request, cells, templates, tiles, sheet, connector, sound & whole)


def _is_tile(template: Template) -> bool:
    return (
        not template.surface and fills_unit_cube(template.mesh.vertices) and is_solid(*_arrays(template.mesh))
    )


def _arrays(mesh: Mesh) -> Arrays:
    return mesh.vertices, mesh.triangles.astype(np.int64)


def solid_of(
    group: int,
    emitted: Emitted,
    layout: SupportLayout,
    ways: Ways,
    obstacles: Obstacles,
    *,
    overlap: float,
    extend: bool,
    on_beams: bool = False,
) -> Mesh | None:
    """Return the closed solid of a support group: cells, seats and connectors; None when it has none.

    With `on_beams` what hangs in the air stays: beams may carry it.
    """
    mine = emitted.of(group) & ~emitted.sheet
    if emitted.sheet.any() and not mine.any() and not on_beams:
        solids = _extras(emitted, group)
        return Mesh(*finish(solids)) if solids else None
    red = layout.connected & (layout.red_group == group)
    seat = np.where(layout.red[:, 0] > 0, min(SEAT, layout.frame.step / 4), 0.0)
    connectors = _connectors(red, seat, layout, ways, overlap)
    ups = [as_manifold(*mesh).simplify(FILE_STEP) for mesh in connectors]  # a tenth of the triangles
    if extend:
        ends = [as_manifold(*mesh) for mesh in _ends(emitted, mine & emitted.connector, seat, layout)]
        ups = [union(ups) ^ union(ends)] if ups and ends else []
    if ups:
        ups = [obstacles.carve(union(ups), layout.group_parts[group], max(overlap, CONTACT_TOLERANCE))]
    ups += _feet(layout, group, obstacles, max(overlap, CONTACT_TOLERANCE))
    seats = red & (layout.red[:, 0] > 0) & ~_stands_on_full_square(emitted, layout) & (not extend)
    trunks = _trunks(emitted, mine & ~emitted.connector, layout.red[seats], float(seat.max(initial=0.0)))
    solids = [as_manifold(*mesh) for mesh in trunks] + ups + _extras(emitted, group)
    if on_beams:
        return Mesh(*finish(solids)) if solids else None
    boxes = foot_boxes(layout, group, max(overlap, CONTACT_TOLERANCE))
    return Mesh(*standing_only(*finish(solids), boxes)) if solids else None


def _feet(layout: SupportLayout, group: int, obstacles: Obstacles, overlap: float) -> list["Manifold"]:
    """Return the feet of a group that stands on parts, none where it does not."""
    feet = make_feet(layout, layout.meshes, group, overlap=overlap, seat=min(SEAT, layout.frame.step / 4))
    if not feet:
        return []
    stood = union([as_manifold(*mesh).simplify(FILE_STEP) for mesh in feet])
    return [obstacles.carve(stood, layout.group_parts[group], overlap, down=True)]


def _connectors(red: Bools, seat: Floats, layout: SupportLayout, ways: Ways, overlap: float) -> list[Arrays]:
    """Return connectors over red squares; they begin in the middle of the seats."""
    held = ways.held.chosen(red[ways.held.owner[:, 0]])
    base = ways.columns.lo[:, 2] - seat / 2
    lid = ways.columns.hi[:, 2] + layout.frame.step
    overlap = max(overlap, CONTACT_TOLERANCE)
    return connect(held, ways.surface, base=base, lid=lid, overlap=overlap, own=ways.own)


def _extras(emitted: Emitted, group: int) -> list["Manifold"]:
    extras = [extra for extra in emitted.cells.extra if extra.group == group and not extra.surface]
    return [as_manifold(*_arrays(extra.mesh)) for extra in extras]


def _trunks(
    emitted: Emitted, chosen: Bools, seats: Ints | None = None, seat: float = 0.0
) -> Iterator[Arrays]:
    """Yield closed meshes of the chosen instances: one or two a direction that tiles, one for each other.

    Parameters
    ----------
    seats, seat
        ``(k, 3)`` squares (plane, y, x) below which plates of `seat` mm go with the cells.
    """
    cells, request = emitted.cells, emitted.request
    tiles, frame = chosen & emitted.tiles, request.frame
    size = np.array([frame.pitch, frame.pitch, frame.step])
    edge, template = cells.edge[tiles], cells.template[tiles].astype(np.int64)
    square = np.column_stack([request.x[edge], request.y[edge], request.plane[edge] - 1]).astype(np.int64)
    shift = np.array(DIRECTIONS, np.int64)[request.direction[edge]][:, ::-1]
    if len(edge) and emitted.whole[template].all():
        yield join_prisms(square, shift, frame.origin, size)
    else:
        for each in np.unique(shift, axis=0):
            own = (shift == each).all(axis=1)
            # a run of cells of one direction is a column of tiles, sheared with them
            place = square[own] + np.outer(square[own, 2], (*each, 0))
            yield from tile(emitted.templates, Tiles(template[own], place, cells.matrix[tiles][own]))
    if seats is not None and len(seats):
        below = seats[:, ::-1].astype(np.int64) - (0, 0, 1)
        yield from tile([plate(seat / frame.step)], _upright(np.zeros(len(below), np.int64), below, frame))
    for index in np.flatnonzero(chosen & ~emitted.tiles):
        one = np.array([cells.template[index]]), cells.matrix[index : index + 1]
        points, triangles, _ = expand(emitted.templates, *one)
        yield points, triangles


def _ends(emitted: Emitted, chosen: Bools, seat: Floats, layout: SupportLayout) -> Iterator[Arrays]:
    """Yield closed meshes of cells that run on above red squares, and of one more below each."""
    yield from _trunks(emitted, chosen)
    lowest = np.flatnonzero(chosen & _on_red(emitted, layout, seat > 0.0))
    cells, request = emitted.cells, emitted.request
    edge = cells.edge[lowest]
    square = np.column_stack([request.x[edge], request.y[edge], request.plane[edge] - 2]).astype(np.int64)
    square, first = np.unique(square, axis=0, return_index=True)
    template = cells.template[lowest][first].astype(np.int64)
    yield from tile(emitted.templates, _upright(template, square, request.frame))


def _upright(template: Ints, cube: Ints, frame: GridFrame) -> Tiles:
    """Return templates upright in the cubes ``(n, 3)`` x, y, layer."""
    size = np.array([frame.pitch, frame.pitch, frame.step])
    matrix = np.zeros((len(cube), 3, 4))
    matrix[:, [0, 1, 2], [0, 1, 2]] = size
    matrix[:, :, 3] = frame.origin + cube * size
    return Tiles(template, cube, matrix)


def _squares(layout: SupportLayout, plane: Ints, y: Ints, x: Ints) -> Ints:
    """Return the numbers of grid squares."""
    _, ny, nx = layout.frame.shape
    return np.asarray((plane.astype(np.int64) * ny + y) * nx + x)


def _on_red(emitted: Emitted, layout: SupportLayout, chosen: Bools) -> Bools:
    """Which instances stand on one of the chosen red squares."""
    request, edge = emitted.request, emitted.cells.edge
    lower = _squares(layout, request.plane - 1, request.y, request.x)[edge]
    return np.isin(lower, _squares(layout, *layout.red[chosen].T))


def _stands_on_full_square(emitted: Emitted, layout: SupportLayout) -> Bools:
    """Which red squares have a cell below them whose top is the whole square."""
    whole = np.array([_top_area(*template) > 1.0 - 1e-6 for template in emitted.templates], np.bool_)
    edge = emitted.cells.edge[emitted.tiles & whole[emitted.cells.template]]
    request = emitted.request
    full = _squares(layout, request.plane[edge], request.y[edge], request.x[edge])
    return np.isin(_squares(layout, *layout.red.T), full)


def _top_area(points: Floats, triangles: Ints) -> float:
    """Area of a template's top, as a share of the square."""
    corners = points[triangles[(points[triangles, 2] > 1.0 - 1e-9).all(axis=1)]]
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.cross(sides[:, 0], sides[:, 1])[:, 2].sum() / 2)


def sheet_of(
    group: int, emitted: Emitted, layout: SupportLayout, ways: Ways, *, overlap: float
) -> Mesh | None:
    """Return the walls without thickness of a support group, up to the faces they hold; None when it has none."""
    mine = emitted.of(group) & emitted.sheet
    cells, request = emitted.cells, emitted.request
    sheets = [_arrays(extra.mesh) for extra in cells.extra if extra.group == group and extra.surface]
    trunk = mine & ~emitted.connector
    if trunk.any():
        sheets.append(
            expand(emitted.templates, cells.template[trunk].astype(np.int64), cells.matrix[trunk])[:2]
        )
    red = np.flatnonzero(layout.connected & (layout.red_group == group))
    ends = np.flatnonzero(mine & emitted.connector & _on_red(emitted, layout, layout.connected))
    columns, segments = [np.empty(0, np.int64)], [np.empty((0, 2, 2))]
    square = _squares(layout, *layout.red[red].T)
    order = np.argsort(square, kind="stable")
    for index in ends:
        edge = cells.edge[index]
        number = _squares(layout, request.plane[edge : edge + 1] - 1, request.y[edge], request.x[edge])
        plan = plan_segments(*emitted.templates[cells.template[index]])
        matrix = cells.matrix[index]
        begin, end = (int(np.searchsorted(square[order], number, side=side)[0]) for side in ("left", "right"))
        for column in red[order[begin:end]]:
            columns.append(np.full(len(plan), column))
            segments.append(plan @ matrix[:2, :2].T + matrix[:2, 3])
    if len(columns) > 1:
        sheets.append(
            raise_sheets(
                ways.columns,
                np.concatenate(columns),
                np.concatenate(segments),
                ways.held,
                ways.surface,
                overlap=max(overlap, CONTACT_TOLERANCE),
            )
        )
    return Mesh(*join_sheets(sheets)) if sheets else None
