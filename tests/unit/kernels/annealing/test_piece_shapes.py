"""Convex pieces and meshes: the engines agree with the boxes they are made of, and rotations are safe."""

import numpy as np
import pytest
from tests.shared import queries as engines
from tests.shared.annealing import ENGINES, l_shape

from amprep.plugins.packers.annealing.shapes import make_shapes

STILL = np.array([1.0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0])
SIZES = [(4.0, 3.0, 4.0), (3.0, 5.0, 2.0)]


def shapes_by(engine):
    return make_shapes([l_shape(engine, size) for size in SIZES], engine)


def random_pairs(rng, count):
    for _ in range(count):
        ray = rng.normal(size=3)
        ray /= np.linalg.norm(ray)
        pose = STILL.copy()
        pose[3::4] = rng.uniform(3, 5) * rng.choice([-1, 1], 3) * rng.permutation([1, 1, 0.3])
        if rng.random() < 0.7:
            ray = rng.normal(0.0, 0.5, 3) - pose[3::4]
            ray /= np.linalg.norm(ray)
        yield pose, tuple(ray)


@pytest.mark.parametrize("margin", [0.0, 0.4])
@pytest.mark.parametrize("engine", ["trees", "pieces"])
def test_meshes_and_pieces_travel_as_far_as_the_boxes_they_are_made_of(engine, margin):
    boxes, shapes = shapes_by("boxes"), shapes_by(engine)
    for pose, ray in random_pairs(np.random.default_rng(2), 60):
        if engines.collide(boxes, 0, pose, 1, STILL, margin):
            continue
        exact = engines.travel(boxes, 0, pose, 1, STILL, ray, margin, 50.0)
        found = engines.travel(shapes, 0, pose, 1, STILL, ray, margin, 50.0)
        # the margin of boxes is taken along the axes, so that they stop earlier at edges
        assert found >= exact - 1e-5
        assert found <= exact + 1e-5 or margin > 0.0


@pytest.mark.parametrize("ray", [(10.0, -3.0, 10.0), (10.0, 3.0, -10.0), (2.0, 1.0, 1.0), (1.0, 1.0, 0.0)])
def test_edges_that_are_on_one_line_seen_along_the_ray_do_not_shorten_the_travel(ray):
    boxes, meshes = shapes_by("boxes"), shapes_by("trees")
    way, compared = tuple(np.array(ray) / np.linalg.norm(ray)), 0
    for back in np.linspace(3.0, 6.0, 25) / max(np.abs(ray)):
        pose = STILL.copy()
        pose[3::4] = np.round(-np.multiply(ray, back), 2)
        if not engines.collide(boxes, 0, pose, 1, STILL, 0.0):
            exact = engines.travel(boxes, 0, pose, 1, STILL, way, 0.0, 50.0)
            assert engines.travel(meshes, 0, pose, 1, STILL, way, 0.0, 50.0) == pytest.approx(exact, abs=1e-6)
            compared += 1
    assert compared > 5


@pytest.mark.parametrize("engine", ["trees", "pieces"])
def test_a_turn_stops_before_small_steps_collide(engine):
    shapes, rng, stopped = shapes_by(engine), np.random.default_rng(5), 0
    for pose, axis in random_pairs(rng, 40):
        point = tuple(pose[3::4] + 1.5)
        if engines.collide(shapes, 0, pose, 1, STILL, 0.1):
            continue
        angle = engines.turn(shapes, 0, pose, 1, STILL, point, axis, 0.1, 3.0)
        stopped += angle < 3.0
        for fraction in np.linspace(0.0, 1.0, 12):
            turned = rotate_about(pose, point, axis, fraction * angle)
            assert not engines.collide(shapes, 0, turned, 1, STILL, 0.1 - 1e-5)
    assert stopped > 3


def rotate_about(pose, point, axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    rows = pose.reshape(3, 4)
    away = turn @ (rows[:, 3] - point) + point
    return np.column_stack((turn @ rows[:, :3], away)).ravel()


@pytest.mark.parametrize("engine", ENGINES)
def test_shapes_within_the_margin_collide(engine):
    shapes, apart = shapes_by(engine), STILL.copy()
    apart[7] = 5.5  # the second shape is 5 mm deep
    assert not engines.collide(shapes, 0, apart, 1, STILL, 0.4)
    assert engines.collide(shapes, 0, apart, 1, STILL, 0.6)
    apart[7] = 4.0
    assert engines.collide(shapes, 0, apart, 1, STILL, 0.0)
