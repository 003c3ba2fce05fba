"""The support layout: everything planned for a whole build, ready for the cells."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Bytes, Floats, Int64s, Ints, frozen
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import CONNECTOR_BLOCKED, NO_FREE_VOXEL_BELOW, REASONS
from amprep.model.supports.edges import SupportEdges
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.grid.territory import PartTerritory

_SAYS_LESS = (CONNECTOR_BLOCKED, NO_FREE_VOXEL_BELOW)
_BY_PRECEDENCE = (*(reason for reason in REASONS if reason not in _SAYS_LESS), *_SAYS_LESS)
"""Reasons in the order in which they count for a point between columns, those of unconnected squares first."""


@dataclass(frozen=True, eq=False)
class SupportLayout:
    """The planned supports of a build: red squares of all parts, edges with flow, and support groups.

    Attributes
    ----------
    grid
        Position and size of the voxels.
    voxels
        ``(nz, ny, nx)`` uint8, values of `amprep.model.supports.Voxel`.
    overhangs
        The overhangs of each placed part.
    red
        The red squares. A square on plane 0 is connected without edges: the plate holds it.
    connected
        ``(m,)`` bool.
    reasons
        ``m`` strings: why a red square is unconnected, ``""`` when it is connected.
    edges
        Edges with their part and group; an edge that several parts share occurs once.
    red_group
        ``(m,)`` int32: support group, -1 for unconnected red squares. A part has one group; parts that share
        squares have the same group.
    group_parts
        Placed parts of each group.
    notes
        Sentences for the user: from the router, about columns on parts, about bracing.
    shared
        One sentence for each group of more than one part.
    feet
        ``(k, 5)`` int32: columns that end on a part; see `amprep.supports.routes.on_part.Grounded`.
    territories
        Where the supports of each part may be; none where parts share all space.
    contact_spacing
        Largest distance (mm) between neighbouring contacts; 0 for that of the grid.
    close
        ``(m,)`` bool, red squares where contacts are at most half of that apart; by default none.
    """

    grid: Grid
    voxels: Bytes
    overhangs: tuple[PartOverhangs, ...]
    red: RedSquares
    connected: Bools
    reasons: tuple[str, ...]
    edges: SupportEdges
    red_group: Ints
    group_parts: tuple[tuple[int, ...], ...]
    notes: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    feet: Ints = field(default_factory=lambda: np.empty((0, 5), np.int32))
    territories: tuple[PartTerritory, ...] = ()
    contact_spacing: float = 0.0
    close: Bools = field(default_factory=lambda: np.empty(0, np.bool_))

    def __post_init__(self) -> None:
        object.__setattr__(self, "red", RedSquares(*(frozen(each, np.int32) for each in self.red)))
        object.__setattr__(self, "red_group", frozen(self.red_group, np.int32))
        object.__setattr__(self, "feet", frozen(self.feet, np.int32, 5))
        object.__setattr__(self, "voxels", frozen(self.voxels, np.uint8))
        object.__setattr__(self, "connected", frozen(self.connected, np.bool_))
        close = self.close if len(self.close) else np.zeros(len(self.connected), np.bool_)
        object.__setattr__(self, "close", frozen(close, np.bool_))

    def reason_at(self, part: int, points: Floats) -> tuple[str, ...]:
        """Return for each point ``(n, 3)`` mm of a part's unsupported overhangs the reason.

        The reason comes from the highest red square of the part that is in the point's column and not above the
        point. If the point is within the rise of the square, the reason is that of the square or, if the square is
        connected, that the connector is blocked. Otherwise there is no free voxel below the point. A point on a line of
        the grid is in the columns on both sides: an unconnected square tells most, and no square at all least.
        """
        sides = [
            self._ranks_at(part, points + (dx, dy, 0.0))
            for dx in (-CONTACT_TOLERANCE, CONTACT_TOLERANCE)
            for dy in (-CONTACT_TOLERANCE, CONTACT_TOLERANCE)
        ]
        return tuple(_BY_PRECEDENCE[rank] for rank in np.min(sides, axis=0).tolist())

    def _ranks_at(self, part: int, points: Floats) -> Int64s:
        """Return the reason at each point from the column that contains it, as an index of `_BY_PRECEDENCE`."""
        ranks = np.full(len(points), _BY_PRECEDENCE.index(NO_FREE_VOXEL_BELOW))
        red_squares = np.flatnonzero(self.red.part == part)
        if not len(red_squares):
            return ranks
        key = self._heights(self.red.square[red_squares])
        order = np.argsort(key)
        size = (self.grid.pitch, self.grid.pitch, self.grid.step)
        voxel = np.floor((points - self.grid.origin) / size + (0.0, 0.0, 0.5)).astype(np.int64)[:, ::-1]
        below = np.searchsorted(key[order], self._heights(voxel), side="right") - 1
        red = red_squares[order[np.maximum(below, 0)]]
        within = (below >= 0) & (voxel[:, 0] <= self.red.square[red, 0] + self.red.rise[red])
        within &= (self.red.square[red, 1:] == voxel[:, 1:]).all(axis=1)
        ranks[within] = self._rank_of_red[red[within]]
        return ranks

    @cached_property
    def _rank_of_red(self) -> Int64s:
        """Index in `_BY_PRECEDENCE` of what each red square says about overhangs without a contact above it."""
        words = [
            CONNECTOR_BLOCKED if connected else reason
            for connected, reason in zip(self.connected.tolist(), self.reasons, strict=True)
        ]
        return np.array([_BY_PRECEDENCE.index(each) for each in words], np.int64)

    def _heights(self, square: Ints | Int64s) -> Int64s:
        """Return numbers that order squares ``(n, 3)`` by column, and upwards in each column."""
        nz, _, nx = self.grid.shape
        plane, y, x = square.T.astype(np.int64)
        return np.asarray((y * nx + x) * (nz + 2) + np.clip(plane, 0, nz + 1), np.int64)


def groups_of(
    edges: SupportEdges, red: RedSquares, connected: Bools, count: int
) -> tuple[Ints, Ints, tuple[tuple[int, ...], ...]]:
    """Return the support group of each red square and edge, and the parts of each group.

    The supports of a part form one group. Parts whose supports are connected have the same group.

    Parameters
    ----------
    edges
        The edges of all supports.
    red
        The red squares.
    connected
        ``(m,)`` bool, the connected red squares.
    count
        Number of placed parts.

    Returns
    -------
    Group of each red square ``(m,)`` (-1 for unconnected ones) and of each edge ``(n,)``, and the parts of each group.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, of_red = edges.components(red.square[connected])
    part = red.part[connected]
    owner = np.full(int(of_red.max(initial=-1)) + 1, -1)
    owner[of_red[::-1]] = part[::-1]
    graph = coo_array((np.ones(len(part)), (part, owner[of_red])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    used, number = np.unique(label[part], return_inverse=True)
    group = np.full(len(red.part), -1, np.int32)
    group[connected] = number
    edge_group = np.searchsorted(used, label[edges.part]).astype(np.int32)
    held = [sorted(set(part[number == i].tolist())) for i in range(len(used))]
    return group, edge_group, tuple(tuple(each) for each in held)
