"""Cut a set of cells along the best plane of the grid into connected sets."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.bounding.grid_cuts.extremes import add_point, estimate_volume, set_frame
from amprep.kernels.bounding.grid_cuts.records import DIRECTIONS, CutWork, Directions, GridCells, MeasuredSets
from amprep.kernels.helper import helper

# Strategy. A plane is valued by the total volume of the hulls of the connected components on both of its sides. For all
# planes normal to an axis these are found in two sweeps, up and down: a sweep adds the cells layer by layer, joins
# them with those of the same and of the last layer, and estimates the hulls of the components that grew. The extreme
# points of the solid in a set are points of its surface, or corners of the set; the corners of a layer are in two
# faces of the box around the set. All other cells matter for the components only. So the planes of a set of n cells
# take O(n) and two estimates each.

BOTH_WASTE = 0.15
"""Weight of the smaller one of the excesses on both sides of a plane.

Many planes through a frame save nothing. One that leaves a bar on one side, and all the waste on the other, is better.
"""


@helper
def _root(parent: Int32s, i: int) -> int:
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@helper
def _start(work: CutWork, cell: int, sweep: int) -> None:
    work.parent[cell] = cell
    work.added[cell] = sweep
    work.joined_volume[cell] = -1.0
    work.joined_empty[cell] = work.empty[cell]
    if not work.empty[cell]:
        for d in range(DIRECTIONS):
            work.joined_value[cell, d] = work.value[cell, d]
            work.joined_point[cell, d] = work.point[cell, d]


@helper
def _join(work: CutWork, i: int, j: int) -> float:
    """Join the components of two cells; return the change of the total volume, before the new hull is measured."""
    a, b = _root(work.parent, i), _root(work.parent, j)
    if a == b:
        return 0.0
    if work.joined_empty[a] and not work.joined_empty[b]:
        a, b = b, a
    change = -max(work.joined_volume[b], 0.0)
    work.parent[b] = a
    if not work.joined_empty[b]:
        change -= max(work.joined_volume[a], 0.0)
        work.joined_volume[a] = -1.0
        value, index = work.joined_value, work.joined_point
        for d in range(DIRECTIONS):
            if value[b, d] > value[a, d]:
                value[a, d] = value[b, d]
                index[a, d] = index[b, d]
    return change


@helper
def _join_neighbours(cells: GridCells, work: CutWork, cell: int, sweep: int, beyond: int, axis: int) -> float:
    """Join a cell with its neighbours that were added; not with those across the plane below layer `beyond`."""
    change = 0.0
    owner = work.owner[cell]
    place, number = cells.place, cells.number
    for k in range(6):
        along = k >> 1
        step = 1 if k & 1 else -1
        to = place[cell, along] + step
        if to < 0 or to >= number.shape[along] or (along == axis and to + (step < 0) == beyond):
            continue
        x = to if along == 0 else place[cell, 0]
        y = to if along == 1 else place[cell, 1]
        z = to if along == 2 else place[cell, 2]
        other = number[x, y, z]
        if other >= 0 and work.owner[other] == owner and work.added[other] == sweep:
            change += _join(work, cell, other)
    return change


@helper
def _sort(cells: GridCells, work: CutWork, members: Int32s, axis: int) -> tuple[int, int]:
    """Sort cells by their layer along an axis; return the first layer and the number of layers."""
    place, layers = cells.place, work.layers
    low, high = place[members[0], axis], place[members[0], axis]
    for i in range(len(members)):
        low = min(low, place[members[i], axis])
        high = max(high, place[members[i], axis])
    for k in range(high - low + 2):
        layers[k] = 0
    for i in range(len(members)):
        layers[place[members[i], axis] - low + 1] += 1
    for k in range(high - low + 1):
        layers[k + 1] += layers[k]
    for i in range(len(members)):
        k = place[members[i], axis] - low
        work.order[layers[k]] = members[i]
        layers[k] += 1
    for k in range(high - low + 1, 0, -1):
        layers[k] = layers[k - 1]
    layers[0] = 0
    return low, high - low + 1


@helper
def _corner(cells: GridCells, x: int, y: int, z: int) -> int:
    """Return the point of a corner of the grid."""
    _, ny, nz = cells.number.shape
    return int(cells.first[-1] + (x * (ny + 1) + y) * (nz + 1) + z)


@helper
def _point(cells: GridCells, cell: int, k: int, least: Int64s, most: Int64s) -> int:
    """Return a point of the surface in a cell, and after all of these its corners; -1 for a corner that is no matter.

    A corner matters if it is in the solid and in two faces of a box of cells.
    """
    corner = k - (cells.first[cell + 1] - cells.first[cell])
    if corner < 0:
        return int(cells.first[cell] + k)
    if not (cells.inside[cell] >> corner) & 1:
        return -1
    x = cells.place[cell, 0] + (corner >> 2)
    y = cells.place[cell, 1] + ((corner >> 1) & 1)
    z = cells.place[cell, 2] + (corner & 1)
    faces = 1 if x == least[0] or x == most[0] + 1 else 0
    faces += 1 if y == least[1] or y == most[1] + 1 else 0
    faces += 1 if z == least[2] or z == most[2] + 1 else 0
    return int(_corner(cells, x, y, z)) if faces > 1 else -1


@helper
def _measure(
    cells: GridCells, work: CutWork, directions: Directions, members: Int32s, found: MeasuredSets, k: int
) -> None:
    """Find the box, the extreme points and the volumes of a set of cells."""
    least, most = np.empty(3, np.int64), np.empty(3, np.int64)
    best = np.full(DIRECTIONS, -np.inf)
    for c in range(3):
        least[c], most[c] = 1 << 30, -1
    for i in range(len(members)):
        for c in range(3):
            least[c] = min(least[c], cells.place[members[i], c])
            most[c] = max(most[c], cells.place[members[i], c])
    frame = found.frame[k]
    low = cells.points[_corner(cells, least[0], least[1], least[2])]
    set_frame(low, cells.points[_corner(cells, most[0] + 1, most[1] + 1, most[2] + 1)], frame)
    found.volume[k] = 0.0
    for i in range(len(members)):
        cell = members[i]
        value, index = work.value[cell], work.point[cell]
        for d in range(DIRECTIONS):
            value[d] = -np.inf
        for e in range(cells.first[cell + 1] - cells.first[cell] + 8):
            p = _point(cells, cell, e, least, most)
            if p >= 0:
                add_point(cells.points, p, frame, directions, value, index)
        work.empty[cell] = 1 if value[0] == -np.inf else 0
        found.volume[k] += cells.volume[cell]
        for d in range(DIRECTIONS):
            if value[d] > best[d]:
                best[d] = value[d]
                found.points[k, d] = index[d]
    found.hull[k] = 0.0
    if best[0] > -np.inf:
        found.hull[k] = estimate_volume(cells.points, frame, directions, best, found.points[k], work.local)


@helper
def _best_plane(
    cells: GridCells, work: CutWork, directions: Directions, members: Int32s, frame: Floats, numbers: Int64s
) -> tuple[int, int]:
    """Return the axis and the layer below which to cut; the axis is -1 if the set has one layer along each."""
    best, best_axis, best_layer = np.inf, -1, 0
    whole = 0.0
    for i in range(len(members)):
        whole += cells.volume[members[i]]
    for axis in range(3):
        low, layers = _sort(cells, work, members, axis)
        for k in range(layers):
            work.total[axis, k] = 0.0
        for sign in range(2):
            numbers[0] += 1
            total = 0.0
            for k in range(layers - 1):
                layer = k if sign == 0 else layers - 1 - k
                first, end = work.layers[layer], work.layers[layer + 1]
                for i in range(first, end):
                    _start(work, work.order[i], numbers[0])
                for i in range(first, end):
                    total += _join_neighbours(cells, work, work.order[i], numbers[0], -1, axis)
                for i in range(first, end):
                    root = _root(work.parent, work.order[i])
                    if work.joined_volume[root] < 0.0 and not work.joined_empty[root]:
                        work.joined_volume[root] = estimate_volume(
                            cells.points,
                            frame,
                            directions,
                            work.joined_value[root],
                            work.joined_point[root],
                            work.local,
                        )
                        total += work.joined_volume[root]
                work.total[axis, layer if sign == 1 else layer + 1] += total
                if sign == 0:
                    work.total[3 + axis, layer + 1] = total
        below = 0.0
        for k in range(1, layers):
            for i in range(work.layers[k - 1], work.layers[k]):
                below += cells.volume[work.order[i]]
            excess = work.total[3 + axis, k] - below
            other = work.total[axis, k] - work.total[3 + axis, k] - (whole - below)
            value = work.total[axis, k] + BOTH_WASTE * max(min(excess, other), 0.0)
            if value < best - 1e-9 * abs(best) or best == np.inf:
                best, best_axis, best_layer = value, axis, low + k
    return best_axis, best_layer


@njit(cache=True, nogil=True)
def cut_cells(
    cells: GridCells,
    work: CutWork,
    directions: Directions,
    members: Int32s,
    frame: Floats,
    numbers: Int64s,
    found: MeasuredSets,
) -> int:
    """Cut a set of cells along the plane after which the hulls of the connected components have the least volume.

    Parameters
    ----------
    cells, work, directions
        All cells, what is known of their sets, and directions.
    members
        The cells of the set; afterwards component by component.
    frame
        The box around the set.
    numbers
        ``(2,)`` number of sweeps, and last number of a set; both are raised. As long as there is no set, none is cut:
        the components of all cells become sets.
    found
        Receives what is known of the components.

    Returns
    -------
    int
        Number of components; 1 for a set that no plane cuts. -1 if there are too many.
    """
    axis, layer = -1, 0
    if numbers[1] > 0:
        axis, layer = _best_plane(cells, work, directions, members, frame, numbers)
    numbers[0] += 1
    for i in range(len(members)):
        work.parent[members[i]] = members[i]
        work.added[members[i]] = numbers[0]
        work.joined_empty[members[i]] = 1
    for i in range(len(members)):
        _join_neighbours(cells, work, members[i], numbers[0], layer, axis)
    count, used = 0, 0
    for i in range(len(members)):
        root = _root(work.parent, members[i])
        if work.added[root] < 0:
            continue
        if count == len(found.end):
            return -1
        numbers[1] += 1
        for j in range(i, len(members)):
            if _root(work.parent, members[j]) == root:
                work.order[used] = members[j]
                work.owner[members[j]] = numbers[1]
                used += 1
        work.added[root] = -1
        found.end[count] = used
        count += 1
    begin = 0
    for i in range(len(members)):
        members[i] = work.order[i]
    for k in range(count):
        _measure(cells, work, directions, members[begin : found.end[k]], found, k)
        begin = found.end[k]
    return count
