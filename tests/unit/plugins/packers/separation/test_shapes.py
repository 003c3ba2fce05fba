"""Shapes of items, and the bounds on their number and on the memory of their fields."""

import numpy as np
import pytest

from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement, Stop
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.shapes import MOST_SHAPES, prepare_shapes

ALL_TURNS = Orientations(matrices=axis_rotations())


def block(x, y, z):
    return Boxes(np.array([1.0, 2, 3]), np.array([1.0 + x, 2 + y, 3 + z]))


def prepared(*items, size=(50, 50, 50), **rules):
    return prepare_shapes(
        PackingProblem(tuple(items), BuildVolume(np.array(size, float)), "height", **rules), Stop()
    )


def test_rotations_of_a_box_that_look_the_same_are_one_shape():
    instance = prepared(
        Item(0, 0, block(1, 2, 3), 1.0, ALL_TURNS), Item(1, 0, block(2, 2, 2), 1.0, ALL_TURNS)
    )
    assert (instance.end - instance.first).tolist() == [6, 1]


def test_copies_share_their_shapes_and_rotations_that_do_not_fit_are_left_out():
    volume = block(1, 2, 30)
    copies = [Item(0, copy, volume, 1.0, ALL_TURNS) for copy in range(2)]
    instance = prepared(*copies, size=(10, 40, 10))
    assert instance.first[0] == instance.first[1]
    assert {shape.size[1] for shape in instance.shapes} == {30.0}
    assert not instance.too_large.any()


def test_types_with_many_orientations_keep_the_lowest_ones():
    volumes = [block(1, 2, 3 + k / 1000) for k in range(MOST_SHAPES)]
    instance = prepared(*(Item(k, 0, volume, 1.0, ALL_TURNS) for k, volume in enumerate(volumes)))
    assert len(instance.shapes) <= MOST_SHAPES
    assert {float(shape.size[2]) for shape in instance.shapes} == {1.0}


def test_of_equally_low_orientations_those_with_other_lengths_and_widths_come_first():
    volumes = [block(1, 2, 3 + k / 1000) for k in range(MOST_SHAPES // 2)]
    instance = prepared(*(Item(k, 0, volume, 1.0, ALL_TURNS) for k, volume in enumerate(volumes)))
    low = [instance.shapes[k].size for k in range(2)]
    assert [size[2] for size in low] == [1.0, 1.0]
    assert low[0][0] == low[1][1] != low[0][1]


@pytest.mark.parametrize("megabytes", [1.0, 5.0])
def test_fields_stay_within_their_memory(megabytes):
    items = [Item(k, 0, block(5, 6 + k, 7), 1.0) for k in range(6)]
    fixed = (Placement(5, np.eye(3), np.array([10.0, 10, 10])),)
    instance = prepared(*items, clearance=1.0, fixed=fixed)
    no_fit = prepare_no_fit(instance, SeparationParams(memory=megabytes), Stop())
    assert no_fit is not None
    assert no_fit.fields.values.nbytes <= megabytes * 1e6
    assert len(no_fit.obstacles) == 1
