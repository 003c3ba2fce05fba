"""Which parts of a build can be taken out, with their supports."""

import numpy as np
from tests.shared.removal import box, hook_in_ring
from tests.shared.solids import mesh_of

from amprep.measures.removal_order import measure_removal_order
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart, SupportBody
from amprep.testing.problems import box_mesh

SETTINGS = BuildSettings("b", BuildVolume(np.full(3, 100.0)))


def placed(name, mesh, at=(0, 0, 0)):
    matrix = np.eye(4)
    matrix[:3, 3] = at
    return PlacedPart(name, Part(name, mesh, 1.0), matrix)


def bracket():
    """A post with an arm over its neighbour."""
    return mesh_of(box((0, 0, 0), (5, 5, 30)) + box((0, 0, 25), (30, 5, 30)))


def test_a_part_below_an_arm_is_lifted_off_after_it():
    build = Build(SETTINGS, (placed("cube", box_mesh([10, 0, 0], [20, 5, 20])), placed("bracket", bracket())))
    order = measure_removal_order(build)
    assert [step.bodies for step in order.steps] == [(1,), (0,)]
    assert order.steps[1].after == (1,)


def test_supports_move_with_their_parts_and_block_others():
    cube = placed("cube", box_mesh([0, 0, 0], [10, 10, 10]), at=(20, 0, 0))
    shelf = placed("shelf", box_mesh([0, 0, 5], [10, 10, 25]))
    leaning = SupportBody("s", box_mesh([5, 2, 15], [30, 8, 18]), (1,))
    order = measure_removal_order(Build(SETTINGS, (cube, shelf), (leaning,)))
    assert [step.bodies for step in order.steps] == [(1,), (0,)]
    assert order.steps[1].after == (1,)


def test_parts_that_share_a_support_leave_together():
    parts = tuple(placed(f"p{k}", box_mesh([0, 0, 5], [10, 10, 10]), at=(20 * k, 0, 0)) for k in range(3))
    shared = SupportBody("s", box_mesh([0, 0, 0], [30, 10, 4]), (0, 1))
    order = measure_removal_order(Build(SETTINGS, parts, (shared,)))
    assert {step.bodies for step in order.steps} == {(0, 1), (2,)}


def test_locked_parts_are_named_also_where_they_are_surfaces():
    hook, ring = (mesh_of(solid) for solid in hook_in_ring())
    surface = PlacedPart("hook", Part("hook", hook, 1.0, is_solid=False), np.eye(4))
    order = measure_removal_order(Build(SETTINGS, (surface, placed("ring", ring))))
    assert order.locked == ((0, 1),)


def test_a_build_of_one_part_or_none_has_an_order():
    alone = Build(SETTINGS, (placed("cube", box_mesh([0, 0, 0], [1, 1, 1])),))
    assert [step.bodies for step in measure_removal_order(alone).steps] == [(0,)]
    assert measure_removal_order(Build(SETTINGS, ())).steps == ()
