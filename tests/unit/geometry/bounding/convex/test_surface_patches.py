"""Patches partition the triangles, and no patch is more concave than asked for."""

import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial import ConvexHull
from tests.shared.convex_solids import SOLIDS, part_of

from amprep.geometry.bounding.convex.surface_patches import DualGraph, convex_patches


def patches_of(name, epsilon):
    vertices, triangles = part_of(SOLIDS[name]()).mesh.arrays
    found = convex_patches(vertices, triangles, epsilon, lambda: False)
    assert found is not None
    return vertices, triangles, found


def concavity(vertices, triangles):
    points = np.concatenate((vertices[np.unique(triangles)], vertices[triangles].mean(axis=1)))
    if np.linalg.matrix_rank(points - points[0], 1e-9) < 3:
        return 0.0
    planes = ConvexHull(points).equations
    return float((-points @ planes[:, :3].T - planes[:, 3]).min(axis=1).max())


@pytest.mark.parametrize("epsilon", [0.1, 1.0])
@pytest.mark.parametrize("name", ["angle", "ring", "open box", "drilled", "spiral"])
def test_patches_are_a_partition_within_the_concavity(name, epsilon):
    vertices, triangles, patches = patches_of(name, epsilon)
    assert sorted(np.concatenate(patches).tolist()) == list(range(len(triangles)))
    assert max(concavity(vertices, triangles[patch]) for patch in patches) <= epsilon + 1e-5


def test_a_convex_solid_is_one_patch_and_a_larger_concavity_gives_fewer():
    assert len(patches_of("cube", 0.1)[2]) == 1
    counts = [len(patches_of("ring", epsilon)[2]) for epsilon in (0.1, 1.0, 3.0)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > counts[-1]


def test_a_stopped_search_gives_none():
    vertices, triangles = part_of(SOLIDS["ring"]()).mesh.arrays
    assert convex_patches(vertices, triangles, 1.0, lambda: True) is None


def test_the_shape_of_a_square_of_two_triangles_is_that_of_a_square():
    vertices, triangles = part_of(Manifold.cube([2, 2, 2])).mesh.arrays
    graph = DualGraph(vertices, triangles)
    diagonal = [
        (v, w) for v in graph.border for w, length in graph.border[v].items() if length > 2.1 and v < w
    ]
    assert len(diagonal) == 6
    for v, w in diagonal:
        assert graph.aspect(v, w) == pytest.approx(8**2 / (4 * np.pi * 4))
        assert graph.diagonal(v, w) == pytest.approx(2 * np.sqrt(2))
        assert graph.united_concavity(v, w) == 0.0


def test_contraction_keeps_areas_borders_and_perimeters():
    vertices, triangles = part_of(SOLIDS["angle"]()).mesh.arrays
    graph = DualGraph(vertices, triangles)
    area = sum(graph.area.values())
    while len(graph.border) > 3:
        v = min(graph.border)
        graph.contract(v, min(graph.border[v]), 0.0)
        assert sum(graph.area.values()) == pytest.approx(area)
        for patch, neighbours in graph.border.items():
            assert graph.perimeter[patch] == pytest.approx(sum(neighbours.values()))
