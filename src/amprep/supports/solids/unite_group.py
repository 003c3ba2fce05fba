"""Unite the cells, seats, connectors and feet of one support group to a solid, or join them as open walls."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.cells.instances import CellInstances, expand_cells, unite_contents
from amprep.geometry.cells.tiling import expand
from amprep.geometry.connectors.connect import connect
from amprep.geometry.connectors.least_width import LeastSection, Posts
from amprep.geometry.connectors.sheets import join_sheets, plan_segments, raise_sheets
from amprep.geometry.merging.union import FILE_STEP, finish, union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Mesh
from amprep.model.contacts import ConnectorRules
from amprep.model.supports.edges import square_keys
from amprep.supports.layout import SupportLayout
from amprep.supports.solids.connectors import ColumnSurfaces, foot_boxes, make_feet
from amprep.supports.solids.extended_cells import extended_cells, on_red
from amprep.supports.solids.keep_out import PartObstacles, drop_floating
from amprep.supports.solids.least_section import post_solids
from amprep.supports.solids.territory import clip_to_territory
from amprep.supports.solids.tips import ShapedConnectors, TipSpacing, shape_connectors, sink_depths

if TYPE_CHECKING:
    from manifold3d import Manifold

SEAT = 0.2
"""Depth (mm) at which connectors begin below their red square, inside the cell there (at most a quarter of a step)."""


class SupportContext(NamedTuple):
    """Data that the supports of all groups of a build share.

    Attributes
    ----------
    layout
        Red squares, edges and groups.
    surfaces
        Surfaces of the parts in the columns above red squares.
    obstacles
        Parts and walls that supports keep away from.
    connector
        Shape of the connectors.
    overlap
        Depth (mm) to which supports enter the parts that they hold, at least `CONTACT_TOLERANCE`.
    posts
        Posts below surfaces that are too narrow for connectors of their own outline; None for none.
    least
        Least section of connectors; None for none.
    """

    layout: SupportLayout
    surfaces: ColumnSurfaces
    obstacles: PartObstacles
    connector: ConnectorRules
    overlap: float
    posts: Posts | None = None
    least: LeastSection | None = None

    def foot_boxes(self, group: int) -> tuple[Floats, Floats]:
        """Return the boxes in which the feet of a group on parts end."""
        return foot_boxes(self.layout, group, self.overlap)

    @property
    def seat(self) -> float:
        """Depth of the seats of connectors, mm."""
        return min(SEAT, self.layout.grid.step / 4)


def solid_of(
    context: SupportContext, group: int, instances: CellInstances, *, on_beams: bool = False
) -> "Manifold | None":
    """Return the solid of a support group, whose pieces may float; None when it has none.

    Parameters
    ----------
    context
        Data of all groups.
    group
        Number of the group.
    instances
        Answer of the cell emitter.
    on_beams
        Whether beams carry the solid: then connectors begin no deeper than `SEAT`.
    """
    layout, instances = context.layout, instances.with_own_contents()
    mine = instances.of(group) & ~instances.sheet
    if instances.sheet.any() and not mine.any() and not on_beams:
        solids = _extras(instances, group)
        return union(solids) if solids else None
    red = layout.connected & (layout.red_group == group)
    seat = np.where(layout.red.square[:, 0] > 0, context.seat, 0.0)
    # beams carry connectors by their ends, so these must not begin deeper
    sink = sink_depths(layout, context.connector, most=SEAT if on_beams else np.inf)
    extend = context.connector.connector == "extend"
    connectors = _plain_connectors(context, red, np.maximum(seat / 2, sink))
    if extend:
        cells_above = extended_cells(instances, mine & instances.connector, seat, layout)
        cells = [as_manifold(*mesh) for mesh in cells_above]
        connectors = [union(connectors) ^ union(cells)] if connectors and cells else []
    connectors += _posts(context, red, np.maximum(seat / 2, sink))
    notch = union([])
    if connectors:
        shaped = _subtract_and_shape(context, group, union(connectors), red, seat / 2, sink, instances)
        connectors, notch = [shaped.connectors], shaped.notch
    connectors += _feet(context, group)
    below = expand_cells(instances, *_cells_below(context, group, instances))
    cells = [*(as_manifold(*mesh) for mesh in below), *_extras(instances, group)]
    cells = cells if notch.is_empty() else [union(cells) - notch]
    solids = context.obstacles.clip(cells + connectors)
    return clip_to_territory(layout, group, union(solids), instances) if solids else None


def unite_patterns(context: SupportContext, instances: CellInstances) -> None:
    """Unite the cells of each voxel for all groups, so that groups with the same patterns of cells share them."""
    for group in range(len(context.layout.group_parts)):
        unite_contents(instances, *_cells_below(context, group, instances))


def _cells_below(context: SupportContext, group: int, instances: CellInstances) -> tuple[Bools, Ints, float]:
    """Return the cells of a group below its red squares, the squares that need a plate, and its thickness in mm."""
    layout = context.layout
    mine = instances.of(group) & ~instances.sheet & ~instances.connector
    above_plate = layout.connected & (layout.red_group == group) & (layout.red.square[:, 0] > 0)
    seats = above_plate & ~_stands_on_full_square(instances, layout)
    seats &= context.connector.connector != "extend"
    return mine, layout.red.square[seats], context.seat if layout.red.square[:, 0].any() else 0.0


def stored_solid(
    solid: "Manifold | None", base: "Manifold | None", feet: tuple[Floats, Floats] | None
) -> Mesh | None:
    """Return a solid with its base as a build file stores it, without floating pieces; None where nothing is left.

    Parameters
    ----------
    solid, base
        Solid of a support group, and its base.
    feet
        Boxes in which feet on parts end; None keeps floating pieces, because beams carry them.
    """
    solids = [each for each in (solid, base) if each is not None]
    arrays = finish(solids)
    mesh = Mesh(*(arrays if feet is None else drop_floating(*arrays, feet)))
    return mesh if len(mesh.triangles) else None


def _plain_connectors(context: SupportContext, red: Bools, depth: Floats) -> list["Manifold"]:
    """Return connectors over whole red squares; they begin `depth` ``(m,)`` mm below their squares."""
    surfaces = context.surfaces
    supported = surfaces.supported.chosen(red[surfaces.supported.owner[:, 0]])
    base = surfaces.columns.lo[:, 2] - depth
    top = surfaces.columns.hi[:, 2] + context.layout.grid.step
    meshes = connect(
        supported,
        surfaces.surface,
        square=surfaces.columns.square,
        base=base,
        top=top,
        overlap=context.overlap,
        own=surfaces.own,
    )
    return [as_manifold(*mesh).simplify(FILE_STEP) for mesh in meshes]  # removes nine tenths of the triangles


def _posts(context: SupportContext, red: Bools, depth: Floats) -> list["Manifold"]:
    """Return the posts in the columns `red` ``(m,)``; they begin `depth` ``(m,)`` mm below their squares."""
    posts, surfaces = context.posts, context.surfaces
    if posts is None or not red[posts.column].any():
        return []
    return [post_solids(posts, surfaces, red, surfaces.columns.lo[:, 2] - depth, context.overlap)]


def _subtract_and_shape(
    context: SupportContext,
    group: int,
    connectors: "Manifold",
    red: Bools,
    depth: Floats,
    sink: Floats,
    instances: CellInstances,
) -> ShapedConnectors:
    """Subtract the parts from connectors, and shape the rest by the rules; `depth` and `sink` ``(m,)`` mm.

    What keeps out of walls and stays in the territory is shaped, because borders that cut tips leave slivers.
    """
    obstacles, held = context.obstacles, context.layout.group_parts[group]
    connectors = obstacles.subtract_from(connectors, held, context.overlap)
    if not context.connector.is_shaped:
        return ShapedConnectors(connectors, union([]))
    connectors = clip_to_territory(context.layout, group, obstacles.clip([connectors])[0], instances)
    contact = obstacles.contact(connectors, held)
    columns = context.surfaces.columns
    columns = columns._replace(lo=columns.lo[red], hi=columns.hi[red], square=columns.square[red])
    base = columns.lo[:, 2] - depth[red]
    spacing = TipSpacing(context.layout.contact_spacing, context.layout.close[red])
    return shape_connectors(
        connectors,
        contact,
        columns,
        base,
        sink[red],
        context.connector,
        spacing,
        context.overlap,
        _stands_on_full_square(instances, context.layout)[red],
        context.least,
    )


def _feet(context: SupportContext, group: int) -> list["Manifold"]:
    """Return the feet of a group on parts as one solid, none where it has no such feet."""
    layout, overlap = context.layout, context.overlap
    feet = make_feet(layout, group, overlap=overlap, seat=context.seat)
    if not feet:
        return []
    united = union([as_manifold(*mesh).simplify(FILE_STEP) for mesh in feet])
    return [context.obstacles.subtract_from(united, layout.group_parts[group], overlap, down=True)]


def _extras(instances: CellInstances, group: int) -> list["Manifold"]:
    extras = [extra for extra in instances.cells.extra if extra.group == group and not extra.surface]
    return [as_manifold(*extra.mesh.arrays) for extra in extras]


def _stands_on_full_square(instances: CellInstances, layout: SupportLayout) -> Bools:
    """Tell which red squares are completely covered by the top of a cell below them."""
    whole = np.array([_top_area(*template) > 1.0 - 1e-6 for template in instances.templates], np.bool_)
    edge = instances.cells.edge[instances.tiles & whole[instances.cells.template]]
    full = square_keys(instances.request.edges.upper[edge])
    return np.isin(square_keys(layout.red.square), full)


def _top_area(points: Floats, triangles: Ints) -> float:
    """Return the area of the top of a template, as a fraction of the square."""
    corners = points[triangles[(points[triangles, 2] > 1.0 - 1e-9).all(axis=1)]]
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.cross(sides[:, 0], sides[:, 1])[:, 2].sum() / 2)


def sheet_of(context: SupportContext, group: int, instances: CellInstances) -> Mesh | None:
    """Return the walls without thickness of a support group, up to the overhangs; None when it has none.

    Parameters
    ----------
    context
        Data of all groups.
    group
        Number of the group.
    instances
        Answer of the cell emitter.
    """
    mine = instances.of(group) & instances.sheet
    cells, surfaces = instances.cells, context.surfaces
    sheets = [extra.mesh.arrays for extra in cells.extra if extra.group == group and extra.surface]
    below = mine & ~instances.connector
    if below.any():
        sheets.append(
            expand(instances.templates, cells.template[below].astype(np.int64), cells.matrix[below])[:2]
        )
    columns, segments = _wall_segments(context.layout, group, instances, mine & instances.connector)
    if len(columns):
        supported, surface = surfaces.supported, surfaces.surface
        sheets.append(
            raise_sheets(surfaces.columns, columns, segments, supported, surface, overlap=context.overlap)
        )
    return Mesh(*join_sheets(sheets)) if sheets else None


def _wall_segments(
    layout: SupportLayout, group: int, instances: CellInstances, chosen: Bools
) -> tuple[Ints, Floats]:
    """Return the walls of the chosen instances at red squares: column ``(k,)`` and ends in plan ``(k, 2, 2)``."""
    cells, edges = instances.cells, instances.request.edges
    red = np.flatnonzero(layout.connected & (layout.red_group == group))
    number = square_keys(layout.red.square[red])
    order = np.argsort(number, kind="stable")
    columns, segments = [np.empty(0, np.int64)], [np.empty((0, 2, 2))]
    for index in np.flatnonzero(chosen & on_red(instances, layout, layout.connected)):
        edge = cells.edge[index]
        own = square_keys(edges.lower[edge : edge + 1])
        plan = plan_segments(*instances.templates[cells.template[index]])
        matrix = cells.matrix[index]
        begin, end = (int(np.searchsorted(number[order], own, side=side)[0]) for side in ("left", "right"))
        for column in red[order[begin:end]]:
            columns.append(np.full(len(plan), column))
            segments.append(plan @ matrix[:2, :2].T + matrix[:2, 3])
    return np.concatenate(columns), np.concatenate(segments)
