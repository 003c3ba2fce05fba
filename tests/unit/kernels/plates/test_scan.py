"""A scan gives at each grid point the sum of the depths there, whatever the turns."""

import numpy as np
from numba import njit
from tests.shared.plates import block, plate_problem

from amprep.kernels.plates.fields import depth_at
from amprep.kernels.plates.scan import add_overlaps, first_free, scan_size
from amprep.model import Boxes, Stop
from amprep.model.part import Orientations
from amprep.model.rotations import quarter_turns
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates.prepare import prepare_plates
from amprep.plugins.packers.plates.state import OnPlates, make_scene
from amprep.plugins.packers.separation.state import WorkBudget


def angle():
    return Boxes(np.zeros((2, 3)), np.array([[6.0, 1.5, 2.0], [1.5, 4.0, 2.0]]))


def scene_of(volumes, size=20.0):
    problem = plate_problem(
        volumes, (size, size, 9.0), orientations=Orientations("list", quarter_turns()), clearance=0.5
    )
    instance = prepare_plates(problem, PlatesParams(step=0.1), Stop())
    return make_scene(instance, PlatesParams(step=0.1), np.random.default_rng(1), WorkBudget(Stop(), 1e9))


@njit
def scan(outlines, cache, shapes, layout, state, item, shape, x, y):
    size = scan_size(outlines, shapes, shape)
    gx, gy = size
    layout.shape[item] = shape
    add_overlaps(outlines, cache, shapes, layout, item, (x, y), size, state)
    expected = np.zeros((gx, gy))
    for i in range(gx):
        for j in range(gy):
            for other in range(layout.shape.size):
                if other != item:
                    u = x + i * outlines.step - layout.position[other, 0]
                    v = y + j * outlines.step - layout.position[other, 1]
                    depth = depth_at(outlines, cache, shapes, shape, layout.shape[other], u, v, state.spent)
                    expected[i, j] += state.weight[item, other] * depth
    return state.sums[: gx * gy].copy().reshape(gx, gy), expected


def test_a_scan_is_the_sum_of_all_depths():
    scene = scene_of([angle(), block(3, 2), angle(), block(5, 1), angle()])
    instance, rng = scene.instance, np.random.default_rng(3)
    shape = np.array([rng.integers(a, b) for a, b in zip(instance.first, instance.end, strict=True)])
    placed = OnPlates(np.arange(5), shape, np.zeros(5, np.int64), rng.uniform(4, 16, (5, 2)))
    state = scene.state(5)
    state.weight[:] = rng.uniform(1.0, 3.0, (5, 5))
    for turn in range(instance.first[0], instance.end[0]):
        found, expected = scan(
            scene.outlines, scene.cache, instance.arrays, scene.layout(placed), state, 0, turn, 4.03, 4.01
        )
        assert expected.max() > 1.0
        np.testing.assert_allclose(found, expected, atol=1e-3)


def test_the_first_free_position_is_beside_what_is_there():
    scene = scene_of([block(4, 4), block(4, 4)])
    placed = OnPlates(
        np.arange(2), scene.instance.first, np.array([0, 0]), np.array([[2.5, 2.5], [0.0, 0.0]])
    )
    layout, state = scene.layout(placed), scene.state(2)
    shape = first_free(
        scene.outlines,
        scene.cache,
        scene.instance.arrays,
        layout,
        state,
        scene.rules(np.arange(2), 1),
        1,
        np.array([1.0, 0.01]),
        1e-5,
    )
    assert shape >= 0
    x, y = layout.position[1]
    assert np.allclose(x, 2.5)
    assert 7.0 - 0.05 <= y <= 7.0 + 1.5 * scene.outlines.step
