from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from manifold3d import Manifold
from tests.shared.coverings import best_partition, part_of
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.orientation import about_z
from amprep.geometry.bounding.boxes.parallel_rectangles import best_angles, planar_items, rectangles_at
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch

OBJECTIVES = ["union", "larger"]


def as_items(points):
    return np.repeat(points[:, None], 4, axis=1)


def with_height(points):
    """Points in the plane as groups of two, one at each end of a vertical edge of length 1."""
    return np.stack(
        [np.pad(p, ((0, 0), (0, 1)), constant_values=z) for z in (0, 1) for p in [points]], axis=1
    )


SETS = st.integers(3, 6).flatmap(lambda n: arrays(float, (n, 2), elements=st.integers(0, 9).map(float)))


@pytest.mark.parametrize("objective", OBJECTIVES)
@given(points=SETS, angle=st.floats(0, 1.5))
@examples(25)
def test_at_one_angle_the_rectangles_are_as_good_as_the_best_of_all_partitions(objective, points, angle):
    rectangles, area = rectangles_at(as_items(points), angle, TwoBoxSearch(objective))
    turned = points @ about_z(angle)[:2, :2].T
    assert area == pytest.approx(best_partition(with_height(turned), objective), abs=1e-6)
    inside = [((turned >= r[:2] - 1e-9) & (turned <= r[2:] + 1e-9)).all(axis=1) for r in rectangles]
    assert np.any(inside, axis=0).all()


@pytest.mark.parametrize("objective", OBJECTIVES)
@given(points=SETS)
@examples(3)
def test_no_angle_of_a_fine_scale_gives_much_smaller_rectangles(objective, points):
    items, search = as_items(points), TwoBoxSearch(objective)
    found = min(rectangles_at(items, angle, search)[1] for angle in best_angles(items, points, objective, 3))
    scale = np.linspace(0, np.pi / 2, 61)
    least = min(rectangles_at(items, angle, search)[1] for angle in scale)
    assert found <= least * 1.02 + 1e-6


@pytest.mark.parametrize("degrees", [0, 17, 45, 80])
def test_two_turned_rectangles_are_found(degrees):
    angle = Manifold.cube([40, 8, 5]) + Manifold.cube([10, 30, 5])
    mesh = part_of(angle.rotate([0, 0, degrees])).mesh
    items = planar_items(mesh.vertices, mesh.triangles)
    best = best_angles(items, mesh.vertices[:, :2], "union", 2)
    assert min(abs((np.degrees(a) + degrees + 45) % 90 - 45) for a in best) < 1e-6


def test_items_contain_the_outline_of_the_projection():
    mesh = part_of(Manifold.sphere(10, 32) + Manifold.cube([30, 4, 2])).mesh
    items = planar_items(mesh.vertices, mesh.triangles)
    low, high = items.min(axis=1), items.max(axis=1)
    for axis, side in product(range(2), (0, 1)):
        extreme = mesh.vertices[mesh.vertices[:, axis].argsort()[-side]][:2]
        assert ((low <= extreme) & (high >= extreme)).all(axis=1).any()
