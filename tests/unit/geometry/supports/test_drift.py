"""Voxels and paths within the drift of red squares, beside the definition spelled out and reachability by networkx."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.supports.drift import DriftLimits, have_path_within, within_drift
from amprep.model.supports.edges import DIRECTIONS

LIMITS = st.builds(
    DriftLimits,
    pitch=st.just(1.0),
    step=st.sampled_from([0.7, 1.0]),
    ratio=st.sampled_from([0.0, 0.3, 1.0]),
    limit=st.sampled_from([0.0, 1.5, 3.0]),
)


def is_near(voxel, red, limits):
    """The rule for one voxel (k, y, x) and one red square above it."""
    above = red[0] - voxel[0] - 1
    away = limits.pitch * np.hypot(red[1] - voxel[1], red[2] - voxel[2])
    ratio = limits.ratio * above * limits.step if limits.ratio else np.inf
    return above >= 0 and away <= max(limits.pitch, min(ratio, limits.limit or np.inf)) + 1e-6


@given(seed=st.integers(0, 2**32), limits=LIMITS)
@examples(40)
def test_a_voxel_is_within_the_drift_exactly_if_one_red_square_above_is_near_enough(seed, limits):
    rng = np.random.default_rng(seed)
    shape = tuple(int(each) for each in rng.integers(1, 8, 3))
    red = np.column_stack([rng.integers(0, high, 4) for high in (shape[0] + 1, *shape[1:])])
    opened = within_drift(red, shape, limits)
    for voxel in np.ndindex(*shape):
        assert opened[voxel] == any(is_near(voxel, each, limits) for each in red.tolist())


@given(seed=st.integers(0, 2**32), limits=LIMITS)
@examples(40)
def test_a_red_square_has_a_path_within_its_drift_exactly_if_networkx_finds_one(seed, limits):
    rng = np.random.default_rng(seed)
    nz, ny, nx_ = (int(each) for each in rng.integers(2, 7, 3))
    free = rng.random((nz, ny, nx_)) < rng.uniform(0.4, 0.95)
    red = np.column_stack([rng.integers(0, high, 5) for high in (nz + 1, ny, nx_)])
    found = have_path_within(free, red, limits)
    for own, has in zip(red.tolist(), found.tolist(), strict=True):
        graph = nx.DiGraph()
        graph.add_node(tuple(own))
        for k, y, x in np.ndindex(*free.shape):
            for dy, dx in DIRECTIONS:
                below = (k, y + dy, x + dx)
                inside = 0 <= below[1] < ny and 0 <= below[2] < nx_
                voxels = [(k, y, x), below]
                if inside and all(free[v] and is_near(v, own, limits) for v in voxels):
                    graph.add_edge((k + 1, y, x), below)
        reached = {tuple(own)} | nx.descendants(graph, tuple(own))
        assert has == any(plane == 0 for plane, _, _ in reached)


@pytest.mark.parametrize(
    ("planes", "distance"), [(0, 2.0), (2, 2.0), (3, 2.0), (6, 4.0), (30, 15.0), (100, 15.0)]
)
def test_the_distance_grows_by_the_ratio_from_one_pitch_to_the_limit(planes, distance):
    assert DriftLimits(2.0, 2.0, 1 / 3, 15.0).at(planes) == pytest.approx(distance, abs=1e-5)


def test_many_red_squares_are_searched_in_parts_of_bounded_size(monkeypatch):
    monkeypatch.setattr("amprep.geometry.supports.drift.CHUNK", 100)
    free = np.ones((9, 12, 12), np.bool_)
    free[4, 3:9, 3:9] = False
    red = np.array([(9, y, x) for y in range(12) for x in range(12)])
    limits = DriftLimits(1.0, 1.0, 1 / 3, 15.0)
    found = have_path_within(free, red, limits).reshape(12, 12)
    # a distance of one pitch is always allowed, and 4/3 mm at the blocked layer: one square sideways
    assert not found[4:8, 4:8].any()
    assert found.sum() == 144 - 16
