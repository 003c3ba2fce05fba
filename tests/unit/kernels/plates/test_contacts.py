"""Separating lines hold for the given layout, give the exact distance, and keep it when items move along them."""

import numpy as np
import pytest
from tests.shared.plates import block, distance_of, plate_problem, region_of

from amprep.model import Boxes, Stop
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates.prepare import prepare_plates
from amprep.plugins.packers.plates.programs import contacts_on
from amprep.plugins.packers.plates.state import OnPlates, make_scene
from amprep.plugins.packers.separation.state import WorkBudget


def two(clearance):
    angle = Boxes(np.zeros((2, 3)), np.array([[6.0, 1.5, 2.0], [1.5, 4.0, 2.0]]))
    problem = plate_problem([angle, block(3, 2)], (30.0, 30.0, 9.0), clearance=clearance)
    instance = prepare_plates(problem, PlatesParams(), Stop())
    return make_scene(instance, PlatesParams(), np.random.default_rng(1), WorkBudget(Stop(), 1e9))


@pytest.mark.parametrize("clearance", [0.0, 2.0])
def test_the_least_separation_is_the_distance_less_the_clearance(clearance):
    scene, rng = two(clearance), np.random.default_rng(7)
    instance, compared = scene.instance, 0
    outlines = [instance.outlines[instance.shapes[k].outline] for k in instance.first]
    while compared < 30:
        position = rng.uniform(10.0, 20.0, (2, 2))
        regions = [region_of(*pair) for pair in zip(outlines, position, strict=True)]
        overlap = (regions[0] ^ regions[1]).area()
        contacts = contacts_on(
            scene, OnPlates(np.arange(2), instance.first, np.zeros(2, np.int64), position), 0, 40.0
        )
        if overlap > 1e-3:
            assert contacts.apart < -clearance
        elif overlap < 1e-12:
            assert contacts.apart == pytest.approx(
                distance_of(regions[0], regions[1], 40.0) - clearance, abs=2e-3
            )
            compared += 1
        normal, right = contacts.lines[:, :2], contacts.lines[:, 2]
        first, second = position[contacts.pairs[:, 0]], position[contacts.pairs[:, 1]]
        kept = ((second - first) * normal).sum(axis=1) - right
        assert kept.min() == pytest.approx(contacts.apart, abs=1e-9)
        assert np.allclose(np.hypot(*normal.T), 1.0)


def test_items_far_apart_or_on_other_plates_have_no_contacts():
    scene = two(0.5)
    position = np.array([[5.0, 5.0], [20.0, 20.0]])
    apart = OnPlates(np.arange(2), scene.instance.first, np.zeros(2, np.int64), position)
    assert len(contacts_on(scene, apart, 0, 1.0).pairs) == 0
    other = apart._replace(position=np.full((2, 2), 10.0), plate=np.array([0, 1]))
    assert len(contacts_on(scene, other, 0, 1.0).pairs) == 0
