"""The cells, seats and connectors of one support group, united to one solid, or put together as sheets."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Ints, MeshArrays
from amprep.cells.instances import CellInstances, expand_cells
from amprep.geometry.cells.tiling import expand
from amprep.geometry.connectors.connect import connect
from amprep.geometry.connectors.sheets import join_sheets, plan_segments, raise_sheets
from amprep.geometry.merging.union import FILE_STEP, finish, union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Mesh
from amprep.model.contacts import ConnectorRules
from amprep.supports.layout import SupportLayout
from amprep.supports.solids.connectors import ColumnSurfaces, foot_boxes, make_feet
from amprep.supports.solids.extended_cells import extended_cells, on_red, squares
from amprep.supports.solids.keep_out import PartObstacles, drop_floating
from amprep.supports.solids.tips import ShapedConnectors, shape_connectors, sink_depths

if TYPE_CHECKING:
    from manifold3d import Manifold

SEAT = 0.2
"""mm; connectors begin this far below their red square, inside what stands there (at most a quarter step)."""


def solid_of(
    group: int,
    instances: CellInstances,
    layout: SupportLayout,
    surfaces: ColumnSurfaces,
    obstacles: PartObstacles,
    *,
    overlap: float,
    connector: ConnectorRules,
    on_beams: bool = False,
) -> Mesh | None:
    """Return the closed solid of a support group: cells, seats and connectors; None when it has none.

    With `on_beams` what hangs in the air stays: beams may carry it.
    """
    mine, extend = instances.of(group) & ~instances.sheet, connector.connector == "extend"
    if instances.sheet.any() and not mine.any() and not on_beams:
        solids = _extras(instances, group)
        return Mesh(*finish(solids)) if solids else None
    red = layout.connected & (layout.red_group == group)
    seat = np.where(layout.red[:, 0] > 0, min(SEAT, layout.frame.step / 4), 0.0)
    sink = sink_depths(layout, connector, most=SEAT if on_beams else np.inf)  # beams carry by their ends
    connectors = _connectors(red, np.maximum(seat / 2, sink), layout, surfaces, overlap)
    ups = [as_manifold(*mesh).simplify(FILE_STEP) for mesh in connectors]  # a tenth of the triangles
    if extend:
        lids = [
            as_manifold(*mesh) for mesh in extended_cells(instances, mine & instances.connector, seat, layout)
        ]
        ups = [union(ups) ^ union(lids)] if ups and lids else []
    notch = union([])
    if ups:
        up = obstacles.subtract_from(union(ups), layout.group_parts[group], max(overlap, CONTACT_TOLERANCE))
        contact = obstacles.contact(up, layout.group_parts[group]) if connector.is_shaped else None
        if contact is not None:
            up, notch = _shaped(up, contact, red, seat / 2, sink, surfaces, connector, overlap)
        ups = [up]
    ups += _feet(layout, group, obstacles, max(overlap, CONTACT_TOLERANCE))
    seats = red & (layout.red[:, 0] > 0) & ~_stands_on_full_square(instances, layout) & (not extend)
    stems = expand_cells(
        instances, mine & ~instances.connector, layout.red[seats], float(seat.max(initial=0.0))
    )
    cells = [*(as_manifold(*mesh) for mesh in stems), *_extras(instances, group)]
    cells = cells if notch.is_empty() else [union(cells) - notch]
    solids = obstacles.clip(cells + ups)
    if on_beams:
        return Mesh(*finish(solids)) if solids else None
    boxes = foot_boxes(layout, group, max(overlap, CONTACT_TOLERANCE))
    return Mesh(*drop_floating(*finish(solids), boxes)) if solids else None


def _feet(layout: SupportLayout, group: int, obstacles: PartObstacles, overlap: float) -> list["Manifold"]:
    """Return the feet of a group that stands on parts, none where it does not."""
    feet = make_feet(layout, layout.meshes, group, overlap=overlap, seat=min(SEAT, layout.frame.step / 4))
    if not feet:
        return []
    stood = union([as_manifold(*mesh).simplify(FILE_STEP) for mesh in feet])
    return [obstacles.subtract_from(stood, layout.group_parts[group], overlap, down=True)]


def _connectors(
    red: Bools, below: Floats, layout: SupportLayout, surfaces: ColumnSurfaces, overlap: float
) -> list[MeshArrays]:
    """Return connectors over red squares; they begin so many mm below them."""
    held = surfaces.held.chosen(red[surfaces.held.owner[:, 0]])
    base = surfaces.columns.lo[:, 2] - below
    lid = surfaces.columns.hi[:, 2] + layout.frame.step
    overlap = max(overlap, CONTACT_TOLERANCE)
    return connect(held, surfaces.surface, base=base, lid=lid, overlap=overlap, own=surfaces.own)


def _shaped(
    up: "Manifold",
    contact: Floats,
    red: Bools,
    below: Floats,
    sink: Floats,
    surfaces: ColumnSurfaces,
    connector: ConnectorRules,
    overlap: float,
) -> ShapedConnectors:
    """Return connectors of the kind asked for, where that is another than whole squares."""
    columns = surfaces.columns
    columns = columns._replace(lo=columns.lo[red], hi=columns.hi[red], square=columns.square[red])
    base = columns.lo[:, 2] - below[red]
    return shape_connectors(up, contact, columns, base, sink[red], connector, max(overlap, CONTACT_TOLERANCE))


def _extras(instances: CellInstances, group: int) -> list["Manifold"]:
    extras = [extra for extra in instances.cells.extra if extra.group == group and not extra.surface]
    return [as_manifold(*extra.mesh.arrays) for extra in extras]


def _stands_on_full_square(instances: CellInstances, layout: SupportLayout) -> Bools:
    """Which red squares have a cell below them whose top is the whole square."""
    whole = np.array([_top_area(*template) > 1.0 - 1e-6 for template in instances.templates], np.bool_)
    edge = instances.cells.edge[instances.tiles & whole[instances.cells.template]]
    request = instances.request
    full = squares(layout, *request.edges.upper[edge].T)
    return np.isin(squares(layout, *layout.red.T), full)


def _top_area(points: Floats, triangles: Ints) -> float:
    """Area of a template's top, as a share of the square."""
    corners = points[triangles[(points[triangles, 2] > 1.0 - 1e-9).all(axis=1)]]
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.cross(sides[:, 0], sides[:, 1])[:, 2].sum() / 2)


def sheet_of(
    group: int, instances: CellInstances, layout: SupportLayout, surfaces: ColumnSurfaces, *, overlap: float
) -> Mesh | None:
    """Return the walls without thickness of a support group, up to the faces they hold; None when it has none."""
    mine = instances.of(group) & instances.sheet
    cells, request = instances.cells, instances.request
    sheets = [extra.mesh.arrays for extra in cells.extra if extra.group == group and extra.surface]
    trunk = mine & ~instances.connector
    if trunk.any():
        sheets.append(
            expand(instances.templates, cells.template[trunk].astype(np.int64), cells.matrix[trunk])[:2]
        )
    red = np.flatnonzero(layout.connected & (layout.red_group == group))
    tops = np.flatnonzero(mine & instances.connector & on_red(instances, layout, layout.connected))
    columns, segments = [np.empty(0, np.int64)], [np.empty((0, 2, 2))]
    square = squares(layout, *layout.red[red].T)
    order = np.argsort(square, kind="stable")
    for index in tops:
        edge = cells.edge[index]
        number = squares(layout, *request.edges.lower[edge : edge + 1].T)
        plan = plan_segments(*instances.templates[cells.template[index]])
        matrix = cells.matrix[index]
        begin, end = (int(np.searchsorted(square[order], number, side=side)[0]) for side in ("left", "right"))
        for column in red[order[begin:end]]:
            columns.append(np.full(len(plan), column))
            segments.append(plan @ matrix[:2, :2].T + matrix[:2, 3])
    if len(columns) > 1:
        sheets.append(
            raise_sheets(
                surfaces.columns,
                np.concatenate(columns),
                np.concatenate(segments),
                surfaces.held,
                surfaces.surface,
                overlap=max(overlap, CONTACT_TOLERANCE),
            )
        )
    return Mesh(*join_sheets(sheets)) if sheets else None
