"""Straighten supports that move sideways without need."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.supports.paths import cheapest_path, edge_prices
from amprep.model.supports import SupportProblem, Voxel
from amprep.model.supports.edges import DIRECTIONS, Square, SupportEdges, square_keys

MORE_MATERIAL = 1.1
"""Largest ratio of the material of an upright and of an oblique edge at which upright edges replace oblique ones."""


class _Chain(NamedTuple):
    """Edges one after another with no branch, no end of another path and no red square between them.

    Attributes
    ----------
    rows
        Numbers of the edges, from the top.
    squares
        The squares from the top, one more than edges.
    """

    rows: list[int]
    squares: list[Square]


def straighten(problem: SupportProblem, edges: SupportEdges) -> SupportEdges:
    """Replace chains of edges that move sideways more than they have to.

    A chain that ends on the plate goes straight down from its first square below which there is a free column that no
    other support uses. A chain between two other squares gets the fewest oblique edges, which are as low as
    possible. Its flow and its capacity stay, and it uses no square of other supports.

    Parameters
    ----------
    problem
        The problem that was solved.
    edges
        Edges that carry flow.
    """
    if problem.material[0] > MORE_MATERIAL * problem.material[1]:
        return edges
    chains = list(_oblique_chains(problem, edges))
    if not chains:
        return edges
    free = problem.voxels == Voxel.FREE
    rows = edges.rows()
    used = {(plane, y, x) for plane, y, x in np.concatenate([edges.upper, edges.lower, problem.red]).tolist()}
    clear = np.logical_and.accumulate(free, axis=0)
    for chain in chains:
        own = set(chain.squares[1:])
        used -= own
        at_plate = chain.squares[-1][0] == 0
        straight = _to_plate(chain, clear, used) if at_plate else _between(chain, free, used)
        if straight is not None:
            flow, capacity = rows[chain.rows[0]][4], max(rows[row][5] for row in chain.rows)
            for row, (square, direction) in zip(chain.rows, straight, strict=True):
                rows[row] = [*square, direction, flow, capacity, rows[row][6]]
            own = {square for square, _ in straight[1:]} | {_below(*straight[-1])}
        used |= own
    return SupportEdges.from_rows(rows).merged()


def _oblique_chains(problem: SupportProblem, edges: SupportEdges) -> Iterator[_Chain]:
    """Yield the chains with more oblique edges than their ends need; the end on the plate may be anywhere."""
    upper, lower = square_keys(edges.upper), square_keys(edges.lower)
    leaving = {key: row for row, key in enumerate(upper.tolist())}
    stops = _branches(upper, lower) | set(square_keys(problem.red).tolist())
    squares = edges.lower.tolist()
    starts = [row for row, key in enumerate(upper.tolist()) if key in stops]
    for start in starts:
        rows = [start]
        while squares[rows[-1]][0] > 0 and (key := int(lower[rows[-1]])) not in stops:
            rows.append(leaving[key])
        first, last = edges.upper[start], edges.lower[rows[-1]]
        needed = 0 if last[0] == 0 else int(np.abs(first[1:] - last[1:]).sum())
        if int(np.count_nonzero(edges.direction[rows])) > needed:
            yield _Chain(rows, [tuple(first.tolist()), *(tuple(squares[row]) for row in rows)])


def _branches(upper: Int64s, lower: Int64s) -> set[int]:
    """Return the keys of squares where not exactly one edge arrives and one leaves."""
    keys = np.concatenate([upper, lower])
    squares, number = np.unique(keys, return_inverse=True)
    leaving = np.bincount(number[: len(upper)], minlength=len(squares))
    arriving = np.bincount(number[len(upper) :], minlength=len(squares))
    return set(squares[(leaving != 1) | (arriving != 1)].tolist())


def _to_plate(chain: _Chain, clear: Bools, used: set[Square]) -> list[tuple[Square, int]] | None:
    """Return the chain down to its first square with a free column below it, and that column."""
    kept: list[tuple[Square, int]] = []
    for here, after in zip(chain.squares, chain.squares[1:], strict=False):
        plane, y, x = here
        column = [(k, y, x) for k in range(plane, -1, -1)]
        if clear[plane - 1, y, x] and used.isdisjoint(column[1:]):
            return [*kept, *((square, 0) for square in column[:-1])]
        kept.append((here, DIRECTIONS.index((after[1] - y, after[2] - x))))
    return None


def _between(chain: _Chain, free: Bools, used: set[Square]) -> list[tuple[Square, int]] | None:
    """Return a chain between the same squares with fewer oblique edges; None if there is none."""
    squares = np.array(chain.squares)
    low, high = squares.min(axis=0), squares.max(axis=0)
    _, y, x = (slice(int(a), int(b) + 1) for a, b in zip(low, high, strict=True))
    prices = edge_prices(free[low[0] : high[0], y, x], 1e-3, 1.0)
    for layer, row, column in np.ndindex(len(prices) - 1, *prices.shape[2:]):  # squares between the ends
        if (layer + 1 + int(low[0]), row + y.start, column + x.start) in used:
            prices[layer, :, row, column] = np.inf
    path = cheapest_path(
        prices,
        (chain.squares[0][1] - y.start, chain.squares[0][2] - x.start),
        (chain.squares[-1][1] - y.start, chain.squares[-1][2] - x.start),
    )
    if path is None or np.count_nonzero(path) >= _oblique_count(chain):
        return None
    found, square = [], chain.squares[0]
    for direction in path:
        found.append((square, direction))
        square = _below(square, direction)
    return found


def _oblique_count(chain: _Chain) -> int:
    steps = np.diff(np.array(chain.squares)[:, 1:], axis=0)
    return int(np.count_nonzero(steps.any(axis=1)))


def _below(square: Square, direction: int) -> Square:
    """Return the square to which an edge leads."""
    dy, dx = DIRECTIONS[direction]
    return square[0] - 1, square[1] + dy, square[2] + dx
