"""Free intervals of vertical lines are the gaps of the solids, and pockets are those of networkx."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.geometry.merging.union import arrays_of
from amprep.kernels.voxels.powder import connect_intervals, cross_lines, free_intervals

NY, NX, SPACING, TOP = 5, 6, 0.5, 4.0


def intervals_of(points, triangles):
    """Return the free intervals of all lines: where those of each line begin, and their heights."""
    place, lines = np.zeros(NY * NX, np.int64), NY * NX
    none = np.zeros(0, np.float32), np.zeros(0, np.int8)
    cross_lines(points, triangles, SPACING, (NY, NX), place, *none)
    first = np.concatenate([[0], np.cumsum(place)])
    heights, signs = np.zeros(first[-1], np.float32), np.zeros(first[-1], np.int8)
    cross_lines(points, triangles, SPACING, (NY, NX), first[:-1].copy(), heights, signs)
    start = np.zeros(lines + 1, np.int64)
    low, high = (np.zeros(int(first[-1]) + lines, np.float32) for _ in range(2))
    count = free_intervals(first, heights, signs, TOP, start, low, high)
    return start, low[:count], high[:count]


def boxes_at_random(rng):
    """Return boxes in the block, with corners that are on no line, and the arrays of their union of meshes."""
    lo = rng.uniform(0.0, 2.5, (4, 3))
    hi = lo + rng.uniform(0.2, 1.5, (4, 3))
    vertices, triangles, count = [], [], 0
    for low, high in zip(lo, hi, strict=True):
        points, corners = arrays_of(Manifold.cube((high - low).tolist()).translate(low.tolist()))
        vertices.append(points)
        triangles.append(corners + count)
        count += len(points)
    return lo, hi, np.concatenate(vertices), np.concatenate(triangles)


@examples(40)
@given(st.integers(0, 10**6))
def test_free_intervals_are_the_heights_at_which_a_line_is_in_no_box(seed):
    lo, hi, points, triangles = boxes_at_random(np.random.default_rng(seed))
    start, low, high = intervals_of(points, triangles)
    for line in range(NY * NX):
        at = np.array([line % NX + 0.5, line // NX + 0.5]) * SPACING
        crossed = (lo[:, :2] < at).all(axis=1) & (at < hi[:, :2]).all(axis=1)
        bounds = sorted({0.0, TOP, *lo[crossed, 2].tolist(), *hi[crossed, 2].tolist()})
        expected: list[list[float]] = []
        for bottom, top in zip(bounds, bounds[1:], strict=False):
            middle = (bottom + top) / 2
            if (crossed & (lo[:, 2] < middle) & (middle < hi[:, 2])).any():
                continue
            if expected and expected[-1][1] == bottom:
                expected[-1][1] = top
            else:
                expected.append([bottom, top])
        here = slice(start[line], start[line + 1])
        assert np.column_stack([low[here], high[here]]) == pytest.approx(
            np.array(expected).reshape(-1, 2), abs=1e-5
        )


@examples(40)
@given(st.integers(0, 10**6))
def test_pockets_are_the_connected_components_of_overlapping_intervals(seed):
    rng = np.random.default_rng(seed)
    heights = [np.sort(rng.uniform(0.0, TOP, (rng.integers(0, 4), 2)).ravel()) for _ in range(NY * NX)]
    for each in heights:
        if len(each) and rng.random() < 0.2:
            each[-1] = TOP
    start = np.concatenate([[0], np.cumsum([len(each) // 2 for each in heights])])
    low, high = np.concatenate(heights).reshape(-1, 2).T.astype(np.float32)
    parent = np.zeros(start[-1] + 1, np.int32)
    connect_intervals((NY, NX), start, np.ascontiguousarray(low), np.ascontiguousarray(high), TOP, parent)

    graph = nx.Graph()
    graph.add_nodes_from(range(start[-1] + 1))
    line = np.repeat(np.arange(NY * NX), np.diff(start))
    y, x = line // NX, line % NX
    for i in range(start[-1]):
        if high[i] >= TOP or x[i] in (0, NX - 1) or y[i] in (0, NY - 1):
            graph.add_edge(0, i + 1)
        for j in range(i):
            beside = abs(y[i] - y[j]) + abs(x[i] - x[j]) == 1
            if beside and max(low[i], low[j]) < min(high[i], high[j]):
                graph.add_edge(i + 1, j + 1)
    smallest = {node: min(component) for component in nx.connected_components(graph) for node in component}
    assert parent.tolist() == [smallest[node] for node in range(start[-1] + 1)]
