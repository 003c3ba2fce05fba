import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.coverings import (
    box_of,
    boxes_volume,
    dense_points,
    in_some_box,
    part_of,
    polygons_of_part,
    solid_of,
)

from amprep.checks.volumes import check_volume
from amprep.geometry.bounding.boxes.covering import CoverSearch, cover_mesh
from amprep.geometry.bounding.boxes.improve import improve
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch
from amprep.model import Boxes

KNOWN = {  # solids of as many boxes as are allowed, and their volume
    "L": ([[0, 0, 0, 30, 10, 7], [0, 0, 7, 11, 10, 40]], 2100 + 3630),
    "U": ([[0, 0, 0, 50, 10, 7], [0, 0, 7, 9, 10, 40], [43, 0, 7, 50, 10, 33]], 3500 + 2970 + 1820),
    "H": ([[0, 0, 0, 9, 10, 50], [40, 0, 0, 50, 10, 50], [9, 0, 21, 40, 10, 30]], 4500 + 5000 + 2790),
    "axes": ([[0, 0, 0, 50, 5, 5], [0, 0, 0, 5, 50, 5], [0, 0, 0, 5, 5, 50]], 1250 + 2 * 1125),
    "F": (
        [[0, 0, 0, 8, 8, 60], [8, 0, 50, 40, 8, 60], [8, 0, 25, 30, 8, 34], [8, 0, 0, 13, 30, 3]],
        3840 + 2560 + 1584 + 450,
    ),
}


def cover(part, boxes=3, **settings):
    search = CoverSearch(boxes=boxes, **settings)
    mesh = part.mesh
    return cover_mesh(mesh.vertices, mesh.triangles, search, rng=np.random.default_rng(1), stop=lambda: False)


@pytest.mark.parametrize("name", KNOWN)
def test_a_solid_of_few_boxes_is_covered_without_any_waste(name):
    boxes, volume = KNOWN[name]
    found = cover(solid_of(boxes), len(boxes))
    assert found.volume == pytest.approx(volume, rel=1e-6)
    assert boxes_volume(found.boxes) == pytest.approx(volume, rel=1e-6)


SOLIDS = {
    "ring": lambda: Manifold.cylinder(5, 20, 20, 64) - Manifold.cylinder(5, 15, 15, 64),
    "turned bracket": lambda: (Manifold.cube([40, 10, 5]) + Manifold.cube([5, 10, 30])).rotate([0, 25, 10]),
    "fan": lambda: (
        Manifold.batch_hull([Manifold.sphere(3, 12), Manifold.sphere(6, 12).translate([30, 8, 3])])
        + Manifold.cylinder(12, 5, 9, 32).translate([0, 20, 0])
        + Manifold.cube([4, 30, 4])
    ),
}


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("boxes", [2, 3, 4])
def test_the_boxes_contain_the_solid_and_no_search_worsens_them(name, boxes):
    part = part_of(SOLIDS[name]())
    found = cover(part, boxes)
    assert len(found.boxes) <= boxes
    assert check_volume(part, Boxes(found.boxes[:, :3], found.boxes[:, 3:])) == []
    assert found.bound <= found.cells_volume * (1 + 1e-12)
    assert found.gap == pytest.approx(1 - found.bound / found.cells_volume)
    assert found.volume <= found.cells_volume * (1 + 1e-9)


def plain_k_means(points, triangles_of, count, restarts):
    """Least union of boxes around clusters of triangles, by k-means on their centroids (Lloyd)."""
    rng, best = np.random.default_rng(0), np.inf
    for _ in range(restarts):
        centres = points[rng.choice(len(points), count, replace=False)]
        for _ in range(20):
            label = np.linalg.norm(points[:, None] - centres, axis=2).argmin(axis=1)
            centres = np.array(
                [points[label == k].mean(axis=0) if (label == k).any() else centres[k] for k in range(count)]
            )
        boxes = [box_of(triangles_of[label == k].reshape(-1, 3)) for k in range(count) if (label == k).any()]
        best = min(best, boxes_volume(boxes))
    return best


@pytest.mark.parametrize("name", SOLIDS)
def test_three_boxes_are_no_larger_than_the_best_of_plain_k_means(name):
    part = part_of(SOLIDS[name]())
    corners = part.mesh.vertices[part.mesh.triangles]
    assert cover(part).volume <= plain_k_means(corners.mean(axis=1), corners, 3, 50)


def test_a_search_that_is_stopped_at_once_still_covers():
    part = part_of(SOLIDS["fan"]())
    mesh = part.mesh
    search = CoverSearch(boxes=3, work=0.0)
    found = cover_mesh(mesh.vertices, mesh.triangles, search, rng=np.random.default_rng(1), stop=lambda: True)
    assert in_some_box(dense_points(part), found.boxes).all()
    assert found.gap > 0


def test_an_improved_covering_is_smaller_and_covers():
    part = solid_of(KNOWN["U"][0])
    loose = np.array([[0.0, 0, 0, 50, 10, 12], [0, 0, 12, 15, 10, 40], [33, 0, 9, 50, 10, 40]])
    better = improve(
        polygons_of_part(part),
        loose,
        3,
        TwoBoxSearch(),
        preferred=((), (), ()),
        passes=5,
        stop=lambda: False,
    )
    assert boxes_volume(better) == pytest.approx(KNOWN["U"][1])
    assert in_some_box(dense_points(part), better).all()
