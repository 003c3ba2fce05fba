"""Connectors fill the space below overhangs up to the lowest face, whatever is above that."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.shared.examples import examples

from amprep.geometry.connectors import connect as connectors
from amprep.geometry.connectors.columns import ConnectorColumns, clip_to_columns
from amprep.geometry.connectors.connect import connect, find_below
from amprep.geometry.merging.union import union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.kernels.meshes.patches import Patches

Floats = NDArray[np.float64]

OVERLAP = 0.01
ONE_COLUMN = ConnectorColumns(
    np.array([[0.0, 0.0, 0.0]]), np.array([[2.0, 2.0, 10.0]]), np.zeros((1, 2), np.int64),
    np.array([0.0, 0.0, 2.0]), (1, 1),
)  # fmt: skip


def tiles(count: int, height: float, *, side: float = 2.0, slope: float = 0.0) -> Floats:
    """Return triangles that face down and divide a square into `count` x `count` tiles."""
    ends = np.linspace(0.0, side, count + 1)
    x, y = (each.ravel() for each in np.meshgrid(ends[:-1], ends[:-1]))
    step = side / count
    corners = [np.stack([x + a, y + b, height + slope * (x + a)], 1) for a, b in _SQUARE * step]
    a, b, c, d = corners
    return np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])


_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def patches_of(layers: Sequence[Floats]) -> Patches:
    """Return the triangles of several layers, clipped to the one column."""
    corners = np.concatenate(list(layers))
    return clip_to_columns(ONE_COLUMN, corners, np.arange(len(corners)), np.array([True]))


def volume_of(layers: Sequence[Floats]) -> float:
    """Return the volume of connectors that support all layers; they do not overlap."""
    patches = patches_of(layers)
    own = np.ones(len(patches.owner), np.bool_)
    square = np.zeros((1, 2), np.int64)
    meshes = connect(
        patches, patches, square=square, base=np.zeros(1), top=np.array([11.0]), overlap=OVERLAP, own=own
    )
    solids = [as_manifold(*mesh) for mesh in meshes]
    assert sum(each.volume() for each in solids) == pytest.approx(union(solids).volume(), rel=1e-6)
    return float(union(solids).volume())


def test_layers_above_the_lowest_add_nothing():
    lowest, above = tiles(2, 3.0), [tiles(3, 4.0), tiles(2, 5.0, slope=0.2)]
    assert volume_of([lowest, *above]) == pytest.approx(4.0 * (3.0 + OVERLAP), rel=1e-6)


def test_columns_with_many_hidden_layers_support_the_lowest():
    """Forty layers of 18 triangles each: most are culled as hidden, and the volume is the same."""
    layers = [tiles(3, 1.0 + 0.2 * each, slope=0.05 * (each % 3)) for each in range(40)]
    assert sum(map(len, layers)) > 10 * connectors.MAX_PATCHES_UNCULLED
    assert volume_of(layers) == pytest.approx(4.0 * (1.0 + OVERLAP), rel=1e-5)


@examples(15)
@given(
    st.lists(
        st.tuples(st.integers(1, 4), st.floats(1.0, 8.0), st.floats(0.5, 2.0), st.floats(-0.4, 0.4)),
        min_size=1, max_size=5,
    )
)  # fmt: skip
def test_connectors_reach_the_lowest_face_above_them(layers):
    """The volume is the integral of the lower envelope, summed on a fine lattice."""
    ends = (np.arange(400) + 0.5) / 200
    x, y = np.meshgrid(ends, ends)
    lowest = np.full(x.shape, np.inf)
    for _, height, side, slope in layers:
        inside = (x < side) & (y < side)
        lowest[inside] = np.minimum(lowest[inside], (height + slope * x)[inside])
    held = np.isfinite(lowest)
    expected = float((lowest[held] + OVERLAP).sum()) * 2e-2 * 2e-2 / 16
    pieces = [tiles(count, height, side=side, slope=slope) for count, height, side, slope in layers]
    assert volume_of(pieces) == pytest.approx(expected, rel=0.02)


def test_exactly_the_patches_below_supported_ones_are_found():
    held, surface = patches_of([tiles(1, 5.0, side=1.0)]), patches_of([tiles(1, 4.0), tiles(1, 6.0)])
    held = held._replace(owner=held.owner + (0, 100))
    lower = surface.owner[:, 1] < 2
    assert lower.any()
    assert (find_below(held, surface) == lower).all()


@pytest.mark.parametrize(("apart", "meshes"), [(1, 2), (2, 1)])
def test_surfaces_share_a_mesh_unless_their_squares_are_neighbours(apart, meshes):
    """The surfaces in the two columns have different heights, so that they are not connected."""
    square = np.array([[0, 0], [0, apart]])
    low = np.column_stack([2.0 * square[:, ::-1], np.zeros(2)])
    columns = ConnectorColumns(low, low + (2.0, 2.0, 10.0), square, np.array([0.0, 0.0, 2.0]), (1, apart + 1))
    corners = np.concatenate([tiles(2, 4.0), tiles(2, 5.0) + (2.0 * apart, 0.0, 0.0)])
    patches = clip_to_columns(columns, corners, np.arange(len(corners)), np.ones(2, np.bool_))
    own = np.ones(len(patches.owner), np.bool_)
    found = connect(
        patches, patches, square=square, base=np.zeros(2), top=np.full(2, 11.0), overlap=OVERLAP, own=own
    )
    assert len(found) == meshes
    assert sum(as_manifold(*mesh).volume() for mesh in found) == pytest.approx(4.0 * (9.0 + 2 * OVERLAP))
