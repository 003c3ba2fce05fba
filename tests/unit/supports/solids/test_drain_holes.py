"""Drain holes in made supports: those that would cut something off are left out, the others stay."""

import numpy as np
import pytest
from manifold3d import Manifold, OpType

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.powder.cavities import find_cavities
from amprep.supports.solids import drain_holes
from amprep.supports.solids.drain_holes import cut_drain_holes

NO_FEET = np.empty((0, 3)), np.empty((0, 3))


def box(lo, hi):
    return Manifold.cube(np.subtract(hi, lo).tolist()).translate(list(lo))


def hollow(x):
    return box((x, 0, 0), (x + 4, 4, 4)) - box((x + 1, 1, 1), (x + 3, 3, 3))


LAMP = hollow(0) + box((1.8, 1.8, 4), (2.2, 2.2, 6)) + box((1, 1, 6), (3, 3, 7))
"""A hollow block that carries a plate on a thin post."""

OPENING = np.array([1.8, -0.1, 1.8]), np.array([2.2, 1.1, 2.2])
CUTTING = np.array([1.0, 1.0, 4.5]), np.array([3.0, 3.0, 5.0])


def given_holes(monkeypatch, *rounds):
    left = list(rounds)
    monkeypatch.setattr(drain_holes, "find_drain_holes", lambda *_: left.pop(0) if left else [])


def test_a_hollow_support_gets_a_hole_by_which_its_powder_leaves():
    opened, (low, high) = cut_drain_holes(hollow(0), [], 0.2, NO_FEET)
    assert len(find_cavities(arrays_of(hollow(0)))) == 1
    assert find_cavities(arrays_of(opened)) == []
    assert len(low) == len(high) == 1


def test_only_the_hole_that_would_cut_something_off_is_left_out(monkeypatch):
    given_holes(monkeypatch, [OPENING, CUTTING], [CUTTING])
    opened, (low, _) = cut_drain_holes(LAMP, [], 0.2, NO_FEET)
    assert low.tolist() == [OPENING[0].tolist()]
    assert find_cavities(arrays_of(opened)) == []
    assert LAMP.volume() - opened.volume() == pytest.approx(0.4 * 0.4 * 1.0)


def test_a_hole_inside_the_box_of_what_would_be_cut_off_but_apart_from_it_is_cut(monkeypatch):
    """The plate carries four legs, which reach down around the block but touch neither it nor the hole."""
    legs = [box((x, y, 0.5), (x + 0.3, y + 0.3, 6.0)) for x in (-1.0, 4.7) for y in (-1.0, 4.7)]
    whole = LAMP + box((-1, -1, 6), (5, 5, 7)) + Manifold.batch_boolean(legs, OpType.Add)
    given_holes(monkeypatch, [OPENING, CUTTING], [CUTTING])
    opened, (low, _) = cut_drain_holes(whole, [], 0.2, NO_FEET)
    assert low.tolist() == [OPENING[0].tolist()]
    assert find_cavities(arrays_of(opened)) == []


def test_pieces_that_floated_before_hinder_no_hole(monkeypatch):
    given_holes(monkeypatch, [OPENING])
    opened, (low, _) = cut_drain_holes(LAMP + box((0, -2, 1), (4, -0.05, 3)), [], 0.2, NO_FEET)
    assert len(low) == 1
    assert find_cavities(arrays_of(opened)) == []


def test_nothing_changes_where_every_hole_would_cut_something_off(monkeypatch):
    given_holes(monkeypatch, [CUTTING])
    opened, (low, _) = cut_drain_holes(LAMP, [], 0.2, NO_FEET)
    assert opened is LAMP
    assert len(low) == 0
