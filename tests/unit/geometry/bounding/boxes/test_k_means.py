import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.coverings import box_of, boxes_volume
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.k_means import cluster_boxes


def volumes_of_smallest_boxes(point, boxes):
    """Volume of the smallest box with the centre and the diagonal direction of each box that contains a point."""
    centre, half = (boxes[:, 3:] + boxes[:, :3]) / 2, (boxes[:, 3:] - boxes[:, :3]) / 2
    scale = (np.abs(point - centre) / half).max(axis=1)
    return scale**3 * np.prod(2 * half, axis=1)


@given(seed=st.integers(0, 10**6), count=st.integers(2, 5))
@examples(30)
def test_clusters_are_a_fixed_point_of_the_two_steps_of_the_thesis(seed, count):
    points = np.random.default_rng(seed).random((60, 3)) * [5, 2, 1]
    labels, boxes = cluster_boxes(np.hstack((points, points)), count, 3, np.random.default_rng(seed))
    assert boxes.tolist() == [box_of(points[labels == n]).tolist() for n in np.unique(labels)]
    if all((labels == n).sum() > 3 for n in np.unique(labels)):  # flat clusters have a least thickness
        rank = np.searchsorted(np.unique(labels), labels)
        for point, own in zip(points, rank, strict=True):
            volumes = volumes_of_smallest_boxes(point, boxes)
            assert volumes[own] <= volumes.min() * (1 + 1e-6) + 1e-12


def test_separate_heaps_are_separate_clusters():
    rng = np.random.default_rng(3)
    heaps = [rng.random((40, 3)) + np.array(place) for place in ([0, 0, 0], [20, 0, 0], [0, 30, 9])]
    points = np.concatenate(heaps)
    _, boxes = cluster_boxes(np.hstack((points, points)), 3, 30, rng)
    assert boxes_volume(boxes) == pytest.approx(sum(boxes_volume([box_of(heap)]) for heap in heaps))


def test_the_same_seed_gives_the_same_boxes():
    points = np.random.default_rng(0).random((100, 3))
    items = np.hstack((points, points + 0.01))
    one, two = (cluster_boxes(items, 4, 5, np.random.default_rng(8))[1] for _ in range(2))
    assert one.tolist() == two.tolist()
    assert (one[:, :3].min(axis=0) == items[:, :3].min(axis=0)).all()
    assert (one[:, 3:].max(axis=0) == items[:, 3:].max(axis=0)).all()
