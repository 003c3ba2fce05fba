"""Reroute paths that drift farther from the overhangs above them than allowed."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.supports.drift import DriftLimits
from amprep.geometry.supports.paths import cheapest_path, edge_prices
from amprep.model.supports import SupportProblem, Voxel
from amprep.model.supports.edges import DIRECTIONS, SupportEdges, square_keys

USED = 0.15
"""Price of an edge that is in use, as a fraction of that of a new edge."""


class _Step(NamedTuple):
    """The edges that lead down from one plane, one for each path: red square ``(n,)`` and edge ``(n,)``."""

    red: Int64s
    edge: Int64s


# Strategy. The flow is taken apart into one path for each red square, plane by plane from the top: at each square, as
# many paths arrive or begin as leave, so that both sorted by square match. A square is too far away if all paths
# through it are farther from their red squares than the drift allows. The paths through such squares are routed again,
# each by itself within its own cone, over edges in use where that is cheaper. What the others carry stays near them,
# so that once is enough.
def reroute_drifting(
    problem: SupportProblem, edges: SupportEdges, connected: Ints, limits: DriftLimits
) -> tuple[SupportEdges, Ints]:
    """Return edges of which each is within the drift of a red square that it carries, and red squares left over.

    Parameters
    ----------
    problem
        The problem that was solved.
    edges
        Edges that carry flow.
    connected
        ``(m,)`` numbers of the red squares in the problem from which the flow starts.
    limits
        Largest horizontal distances.

    Returns
    -------
    The edges, and the numbers of the red squares that no path within the drift connects.
    """
    steps = list(take_apart(edges, problem.red, connected))
    drifting = _drifting(problem, edges, steps, limits)
    if not drifting.size:
        return edges, drifting
    network = _UnitFlow(problem, edges, limits)
    for red in drifting.tolist():
        network.remove(np.concatenate([step.edge[step.red == red] for step in steps]))
    lost = [red for red in drifting.tolist() if not network.add(problem.red[red])]
    return network.edges(), np.array(lost, np.int64)


def take_apart(edges: SupportEdges, red: Ints, connected: Ints) -> Iterator[_Step]:
    """Yield the steps of one path for each connected red square, from the highest plane down to the plate."""
    key, square = square_keys(edges.upper), square_keys(red)
    going, at = np.empty(0, np.int64), np.empty(0, np.int64)
    for plane in range(int(edges.plane.max(initial=0)), 0, -1):
        new = connected[red[connected, 0] == plane]
        going, at = np.concatenate([going, new]), np.concatenate([at, square[new]])
        order = np.lexsort((going, at))
        own = np.flatnonzero(edges.plane == plane)
        own = own[np.lexsort((edges.direction[own], key[own]))]
        edge = np.repeat(own, edges.flow[own])
        going, at = going[order], square_keys(edges.lower[edge])
        yield _Step(going, edge)


def _drifting(
    problem: SupportProblem, edges: SupportEdges, steps: list[_Step], limits: DriftLimits
) -> Int64s:
    """Return the red squares with a path through a square that is too far away from all red squares it carries."""
    found = [np.empty(0, np.int64)]
    for red, edge in steps:
        lower, from_red = edges.lower[edge], problem.red[red]
        away = problem.grid.pitch * np.hypot(*(lower - from_red)[:, 1:].T)
        near = away <= limits.at(from_red[:, 0] - lower[:, 0] - 1)
        _, number = np.unique(square_keys(lower), return_inverse=True)
        carries = np.bincount(number, weights=near, minlength=1)[number] > 0
        found.append(red[~carries])
    return np.unique(np.concatenate(found))


class _UnitFlow:
    """A flow from which single paths are removed, and to which others are added."""

    def __init__(self, problem: SupportProblem, edges: SupportEdges, limits: DriftLimits) -> None:
        self._edges, self._flow, self._limits = edges, edges.flow.astype(np.int64), limits
        self._free, self._costs = problem.voxels == Voxel.FREE, problem.costs
        self._added: list[list[int]] = []

    def remove(self, path: Int64s) -> None:
        """Remove one path, given by the numbers of its edges."""
        self._flow[path] -= 1

    def add(self, red: Ints) -> bool:
        """Add the cheapest path from a red square within its drift; tell whether there is one."""
        plane, y, x = (int(each) for each in red)
        reach = self._limits.squares(plane)
        first = np.array([0, max(y - reach, 0), max(x - reach, 0)])
        inner = self._free[:plane, first[1] : y + reach + 1, first[2] : x + reach + 1]
        vertical, oblique = (max(cost, 1) for cost in self._costs)
        prices = edge_prices(inner & self._cone(inner.shape, red - first), vertical, oblique)
        self._discount(prices, first)
        path = cheapest_path(prices, (y - int(first[1]), x - int(first[2])), None)
        for direction in path or ():
            self._added.append([plane, y, x, direction, 1, 1, 0])
            plane, y, x = plane - 1, y + DIRECTIONS[direction][0], x + DIRECTIONS[direction][1]
        return path is not None

    def edges(self) -> SupportEdges:
        """Return the edges that carry flow."""
        old = replace(self._edges, flow=self._flow, capacity=self._flow)[self._flow > 0]
        return SupportEdges.concatenate([old, SupportEdges.from_rows(self._added)]).merged()

    def _cone(self, shape: tuple[int, ...], red: Ints) -> Bools:
        """Tell which voxels of a block are within the drift of a red square at the top of it."""
        nz, ny, nx = shape
        away = self._limits.pitch * np.hypot(np.arange(ny)[:, None] - red[1], np.arange(nx) - red[2])
        limits = self._limits.at(np.arange(nz - 1, -1, -1))
        return np.asarray(away <= limits[:, None, None])

    def _discount(self, prices: Floats, first: Ints) -> None:
        """Lower the prices of the edges in use, in a block that begins at voxel `first`."""
        rows = np.array(self._added, np.int64).reshape(-1, 7)[:, :4]
        kept = self._flow > 0
        edges = self._edges
        used = np.column_stack([edges.plane, edges.y, edges.x, edges.direction])[kept]
        plane, y, x, direction = np.concatenate([used, rows]).T
        layer, y, x = plane - 1, y - first[1], x - first[2]
        inside = (layer < len(prices)) & (y >= 0) & (x >= 0) & (y < prices.shape[2]) & (x < prices.shape[3])
        prices[layer[inside], direction[inside], y[inside], x[inside]] *= USED
