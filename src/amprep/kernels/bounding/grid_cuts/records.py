"""Records of the kernels that cut solids along the planes of a grid."""

from typing import NamedTuple

from amprep.arrays import Bytes, Floats, Int32s, Int64s

DIRECTIONS = 98
"""Number of directions in which extreme points of sets are known."""


class GridPlanes(NamedTuple):
    """Planes of a rectilinear grid normal to each axis, ascending."""

    x: Floats
    y: Floats
    z: Floats


class ClippedSurface(NamedTuple):
    """A surface clipped to the cells of a grid; cell (x, y, z) has the number (x ny + y) nz + z.

    Attributes
    ----------
    points, cells
        ``(n, 3)`` and ``(n,)`` corners of the clipped triangles, and their cells.
    area, volume
        ``(nx ny nz,)`` zeros; receive the projected area of the surface in each cell, and the volume between it and
        the floor of the cell, both negative for surface that faces down.
    """

    points: Floats
    cells: Int64s
    area: Floats
    volume: Floats


class Directions(NamedTuple):
    """Directions that triangulate the sphere.

    Attributes
    ----------
    normals
        ``(DIRECTIONS / 2, 3)``; the others are their opposites, in the same order.
    triangles
        ``(t, 3)``, counter-clockwise seen from outside.
    inverse
        ``(t, 3, 3)`` inverse matrices of the three directions of each triangle.
    """

    normals: Floats
    triangles: Int32s
    inverse: Floats


class GridCells(NamedTuple):
    """Cells of a grid that a solid meets.

    Attributes
    ----------
    place
        ``(n, 3)`` indices of each cell in the grid.
    number
        ``(nx, ny, nz)`` number of the cell at each place; -1 where the solid has nothing.
    first
        ``(n + 1,)`` first point of the surface in each cell.
    points
        ``(p, 3)`` points of the surface, cell by cell, and then the corners of all cells of the grid.
    inside
        ``(n,)`` bits: whether corner 4 i + 2 j + k of a cell is inside the solid, where it is at its upper end along x
        if i is 1, and so on.
    volume
        ``(n,)`` volume of the solid in each cell.
    """

    place: Int32s
    number: Int32s
    first: Int64s
    points: Floats
    inside: Bytes
    volume: Floats


class CutWork(NamedTuple):
    """What is known of sets of cells, and work arrays; a row for each cell unless it is said.

    Attributes
    ----------
    owner
        ``(n,)`` number of the set of each cell.
    empty
        ``(n,)`` 1 for a cell without points that could be extreme in its set.
    value, point
        ``(n, DIRECTIONS)`` greatest products of the points in a cell with the directions, and the points. Coordinates
        are relative to the box around the set.
    parent, added, joined_value, joined_point, joined_empty, joined_volume
        A union-find forest, the sweep that added a cell, and the same for components.
    order, layers, total
        ``(n,)``, ``(most + 1,)`` and ``(6, most)`` cells by layer, the first of each layer, and for each axis the
        volume of the hulls after a cut below each layer; in the last three rows of those below the cut.
    local
        ``(DIRECTIONS, 3)`` coordinates of extreme points.
    """

    owner: Int32s
    empty: Bytes
    value: Floats
    point: Int32s
    parent: Int32s
    added: Int32s
    joined_value: Floats
    joined_point: Int32s
    joined_empty: Bytes
    joined_volume: Floats
    order: Int32s
    layers: Int64s
    total: Floats
    local: Floats


class MeasuredSets(NamedTuple):
    """What is known of the sets that a cut makes, a row for each.

    Attributes
    ----------
    end
        ``(k,)`` end of the set among the cells.
    frame
        ``(k, 6)`` least corner of the box around it, and the reciprocals of its sides.
    points
        ``(k, DIRECTIONS)`` extreme points.
    hull, volume
        ``(k,)`` volume of the hull, nearly, and of the solid.
    """

    end: Int64s
    frame: Floats
    points: Int32s
    hull: Floats
    volume: Floats
