"""Replace edges by a declared cell: choose a variant for each edge, and make templates for each direction."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.errors import JobError
from amprep.geometry.cells.implicit import implicit_solid
from amprep.geometry.cells.ports import conform
from amprep.geometry.cells.struts import Graph, graph_solid
from amprep.model import (
    Beams,
    CellRequest,
    Cells,
    DeclaredCell,
    GraphCell,
    ImplicitCell,
    Mesh,
    MeshCell,
    Role,
    Shape,
    Template,
    When,
)

LOAD_STEPS = 8
"""Number of steps in which radii grow with the load; it bounds the number of templates."""


class Fitted(NamedTuple):
    """Edges that get the same template.

    Attributes
    ----------
    variant
        Index of the variant.
    factor
        Factor by which the radii of its struts grow with the load.
    edges
        ``(k,)`` indices of edges.
    """

    variant: int
    factor: float
    edges: Ints


def emit_declared(cell: DeclaredCell, request: CellRequest, *, solid: bool = True) -> Cells:
    """Replace each edge by the first variant that fits it.

    Parameters
    ----------
    cell, request
        Cell, and edges to replace.
    solid
        Whether struts become templates instead of beams. If `request.beams` is not None, it decides.

    Raises
    ------
    ValueError
        If the function of an implicit cell does not return numbers.
    JobError
        If this function is nowhere positive.
    """
    solid = solid if request.beams is None else not request.beams
    templates: list[Template] = []
    which, edges = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    beams: list[Beams] = []
    for fitted in fit(cell, request):
        shape = cell.variants[fitted.variant].shape
        if isinstance(shape, GraphCell) and not solid:
            beams.append(beams_of(shape, request, fitted))
            if not len(shape.faces):
                continue
            shape = GraphCell(shape.points, faces=shape.faces, thickness=shape.thickness)
        linear = request.matrices[fitted.edges[0], :, :3]
        for template in templates_of(f"{fitted.variant}", shape, linear, fitted.factor):
            if template.surface and not request.allow_surface:
                continue
            which.append(np.full(len(fitted.edges), len(templates)))
            edges.append(fitted.edges)
            templates.append(template)
    edge = np.concatenate(edges)
    return Cells(tuple(templates), np.concatenate(which), edge, request.matrices[edge], beams=_joined(beams))


def fit(cell: DeclaredCell, request: CellRequest) -> Iterator[Fitted]:
    """Yield sets of edges that get the same template; an edge is in one set at most."""
    left = np.ones(len(request.edges), np.bool_)
    for number, variant in enumerate(cell.variants):
        fits = left & edges_for(variant.when, request)
        left &= ~fits
        factors = _factors(variant.shape, request.edges.flow)
        # only graphs, whose radii are in mm, depend on the map
        direction = request.edges.direction
        directions = direction if isinstance(variant.shape, GraphCell) else 0 * direction
        keys = np.column_stack([directions, factors])[fits]
        for direction, factor in np.unique(keys, axis=0).tolist():
            same = fits & (directions == direction) & (factors == factor)
            yield Fitted(number, float(factor), np.flatnonzero(same))


def edges_for(when: When, request: CellRequest) -> Bools:
    """Tell which edges of the request fulfil every condition, ``(n,)``."""
    edges = request.edges
    fits = (edges.flow >= when.least_load) & (edges.flow <= when.most_load)
    fits &= (edges.plane - 1) % when.every == when.layer
    if when.edges != "any":
        fits &= (edges.direction == 0) == (when.edges == "straight")
    if when.roles:
        words = {"trunk": Role.TRUNK, "foot": Role.FOOT, "connector": Role.CONNECTOR}
        own = np.isin(request.role, [words[word] for word in when.roles if word in words])
        if "surface" in when.roles:
            own |= (request.role == Role.TRUNK) & ~sides_taken(request).all(axis=1)
        fits &= own
    return np.asarray(fits)


def sides_taken(request: CellRequest) -> Bools:
    """Tell on which of its sides (-x, +x, -y, +y) each edge has a neighbour of the same direction, ``(n, 4)``."""
    edges = request.edges
    ny, nx = int(edges.y.max(initial=0)) + 3, int(edges.x.max(initial=0)) + 3
    place = (edges.plane.astype(np.int64) * 5 + edges.direction) * ny * nx
    place += (edges.y + 1) * nx + edges.x + 1
    return np.column_stack([np.isin(place + step, place) for step in (-1, 1, -nx, nx)])


def templates_of(name: str, shape: Shape, linear: Floats, factor: float = 1.0) -> Iterator[Template]:
    """Yield the templates of a shape: a solid, a sheet, or both.

    Parameters
    ----------
    name
        Last part of the template's name.
    shape
        Shape in the unit cube.
    linear
        ``(3, 3)`` linear part of the map of the edges that get the templates.
    factor
        Factor on the radii of struts.

    Raises
    ------
    ValueError
        If the function of an implicit cell does not return numbers.
    JobError
        If this function is nowhere positive on its grid.
    """
    if isinstance(shape, MeshCell):
        yield Template(f"mesh {name}", _conforming(shape), shape.surface)
    elif isinstance(shape, ImplicitCell):
        points, triangles = implicit_solid(shape.function, shape.resolution)
        if not len(triangles):
            raise JobError(
                "the cell is empty: its function is nowhere positive on its grid; increase its resolution"
            )
        yield Template(f"implicit {name}", _mesh(points, triangles))
    else:
        if len(shape.struts) or shape.thickness:
            graph = Graph(shape.points, shape.struts, factor * shape.radii, shape.faces, shape.thickness)
            yield Template(f"graph {name}", _mesh(*graph_solid(graph, linear)))
        if shape.is_sheet:
            yield Template(f"sheet {name}", Mesh(shape.points, shape.faces), surface=True)


def beams_of(shape: GraphCell, request: CellRequest, fitted: Fitted) -> Beams:
    """Return the struts of a set of edges as round beams.

    Parameters
    ----------
    shape
        Graph whose struts become beams.
    request
        Request that contains the edges.
    fitted
        The edges, and the factor on the radii.
    """
    matrix = request.matrices[fitted.edges]
    nodes = np.einsum("nij,vj->nvi", matrix[:, :, :3], shape.points) + matrix[:, None, :, 3]
    first = np.arange(len(matrix)) * len(shape.points)
    struts = (shape.struts[None] + first[:, None, None]).reshape(-1, 2)
    radii = np.tile(fitted.factor * shape.radii, (len(matrix), 1))
    group = np.repeat(request.edges.group[fitted.edges], len(shape.struts))
    return Beams(nodes.reshape(-1, 3), struts.astype(np.int32), radii, group)


def _joined(beams: list[Beams]) -> Beams | None:
    """Concatenate beams, merge nodes at the same place, and keep one of equal beams in a group."""
    if not beams:
        return None
    first = np.cumsum([0, *(len(each.nodes) for each in beams[:-1])])
    nodes = np.concatenate([each.nodes for each in beams])
    struts = np.concatenate([each.struts + start for each, start in zip(beams, first, strict=True)])
    radii, group = (np.concatenate([getattr(each, name) for each in beams]) for name in ("radii", "group"))
    _, kept, place = np.unique(np.round(nodes, 6), axis=0, return_index=True, return_inverse=True)
    struts = place.reshape(-1)[struts]
    _, different = np.unique(np.column_stack([np.sort(struts, axis=1), group]), axis=0, return_index=True)
    different = np.sort(different)
    return Beams(nodes[kept], struts[different].astype(np.int32), radii[different], group[different])


def _factors(shape: Shape, load: Ints) -> Floats:
    """Return the factor on the radii of each edge; the cross-section grows linearly with the load, in steps."""
    if not isinstance(shape, GraphCell) or shape.growth == 1.0:
        return np.ones(len(load))
    fraction = np.clip((load - 1) / (shape.full_load - 1), 0.0, 1.0)
    return np.asarray(np.sqrt(1.0 + np.ceil(fraction * LOAD_STEPS) / LOAD_STEPS * (shape.growth**2 - 1.0)))


def _conforming(shape: MeshCell) -> Mesh:
    if shape.surface:
        return shape.mesh
    return _mesh(*conform(*shape.mesh.arrays))


def _mesh(points: Floats, triangles: Ints) -> Mesh:
    return Mesh(points, triangles)
