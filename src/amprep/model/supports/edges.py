"""The edges of a support network: one record from the router to the cells."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from amprep.arrays import Bytes, Int64s, Ints, frozen
from amprep.geometry.supports.paths import DIRECTIONS

__all__ = ["DIRECTIONS", "Square", "SupportEdges", "square_keys"]

Square = tuple[int, int, int]
"""Plane, y, x."""


@dataclass(frozen=True, eq=False)
class SupportEdges:
    """Edges of a support network, from the router's plan to the cells that replace them.

    Edge e leads from the upper square (plane, y, x) to the lower square (plane - 1, y + dy, x + dx), where
    (dy, dx) is ``DIRECTIONS[direction]``.

    Attributes
    ----------
    plane, y, x
        ``(n,)`` int32, the upper square.
    direction
        ``(n,)`` uint8, index into `DIRECTIONS`.
    flow
        ``(n,)`` int32, number of paths on the edge.
    capacity
        ``(n,)`` int32, final capacity of the edge, at least its flow.
    part
        ``(n,)`` int32, index of the placed part the edge was routed for first; routers leave it 0.
    group
        ``(n,)`` int32, support group; -1 until groups are formed.

    Raises
    ------
    ValueError
        If the arrays differ in length.
    """

    plane: Ints
    y: Ints
    x: Ints
    direction: Bytes
    flow: Ints
    capacity: Ints
    part: Ints = field(default_factory=lambda: np.zeros((), np.int32))
    group: Ints = field(default_factory=lambda: np.full((), -1, np.int32))

    def __post_init__(self) -> None:
        count = np.shape(self.plane)
        for name in ("part", "group"):
            if np.ndim(getattr(self, name)) == 0:
                object.__setattr__(self, name, np.broadcast_to(getattr(self, name), count))
        for name in ("plane", "y", "x", "flow", "capacity", "part", "group"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int32))
        object.__setattr__(self, "direction", frozen(self.direction, np.uint8))
        lengths = sorted({len(each) for each in self.columns})
        if len(lengths) != 1:
            raise ValueError(f"the arrays of support edges must be equally long, got lengths {lengths}")

    @classmethod
    def from_rows(cls, rows: Sequence[Sequence[int]]) -> "SupportEdges":
        """Return edges from rows of plane, y, x, direction, flow, capacity, part."""
        return cls(*np.array(rows, np.int64).reshape(-1, 7).T)

    @classmethod
    def concatenate(cls, blocks: Sequence["SupportEdges"]) -> "SupportEdges":
        """Return the edges of all blocks, one block after the other."""
        columns = zip(*(block.columns for block in (cls.from_rows([]), *blocks)), strict=True)
        return cls(*(np.concatenate(each) for each in columns))

    def rows(self) -> list[list[int]]:
        """Return rows of plane, y, x, direction, flow, capacity, part, as `from_rows` reads them."""
        rows: list[list[int]] = np.column_stack([each.astype(np.int64) for each in self.columns[:7]]).tolist()
        return rows

    def __len__(self) -> int:
        return len(self.plane)

    def __getitem__(self, chosen: Any) -> "SupportEdges":
        """Return the edges that an index array or a mask chooses."""
        return SupportEdges(*(each[chosen] for each in self.columns))

    @cached_property
    def upper(self) -> Ints:
        """``(n, 3)`` int32 plane, y, x of the upper squares."""
        return frozen(np.column_stack([self.plane, self.y, self.x]), np.int32, 3)

    @cached_property
    def lower(self) -> Ints:
        """``(n, 3)`` int32 plane, y, x of the lower squares."""
        step = np.insert(np.array(DIRECTIONS, np.int32)[self.direction], 0, -1, axis=1)
        return frozen(self.upper + step, np.int32, 3)

    @property
    def voxels(self) -> Ints:
        """``(2 n, 3)`` int32 k, y, x: for each edge the voxel below its upper and the one above its lower square."""
        return np.stack([self.upper - (1, 0, 0), self.lower], axis=1).reshape(-1, 3).astype(np.int32)

    def merged(self) -> "SupportEdges":
        """Return each edge once, sorted: the sum of the flows, the largest capacity, the first part and group."""
        key = square_keys(self.upper) * len(DIRECTIONS) + self.direction
        _, first, same = np.unique(key, return_index=True, return_inverse=True)
        flow = np.bincount(same, weights=self.flow).astype(np.int32)
        capacity = flow.copy()
        np.maximum.at(capacity, same, self.capacity)
        return replace(self[first], flow=flow, capacity=capacity)

    def components(self, squares: Ints) -> tuple[Ints, Ints]:
        """Label the connected components that the edges form.

        Parameters
        ----------
        squares
            ``(m, 3)`` further squares; a square without an edge is a component of its own.

        Returns
        -------
        Component of each edge ``(n,)``, and of each of the squares ``(m,)``.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        ends = np.concatenate([self.upper, self.lower, squares])
        _, number = np.unique(square_keys(ends), return_inverse=True)
        count, n = int(number.max(initial=-1)) + 1, len(self)
        graph = coo_array((np.ones(n, np.int8), (number[:n], number[n : 2 * n])), shape=(count, count))
        label = connected_components(graph, directed=False)[1] if count else np.empty(0, np.int32)
        return label[number[:n]], label[number[2 * n :]]

    def voxel_parts(self) -> dict[tuple[int, int, int], int]:
        """Return the voxels (k, y, x) that the edges use, each with the part of one edge that uses it."""
        parts = np.repeat(self.part, 2).tolist()
        return {(k, y, x): part for (k, y, x), part in zip(self.voxels.tolist(), parts, strict=True)}

    @property
    def columns(self) -> tuple[Ints | Bytes, ...]:
        """All arrays, in the order of the constructor."""
        return (self.plane, self.y, self.x, self.direction, self.flow, self.capacity, self.part, self.group)


def square_keys(square: Ints) -> Int64s:
    """Return a number for each square ``(n, 3)`` that orders squares by plane, y, x."""
    plane, y, x = square.T.astype(np.int64)
    return np.asarray((plane << 40) | (y << 20) | x)
