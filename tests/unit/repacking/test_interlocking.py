"""Parts that are locked into each other are placed elsewhere, where all can be taken out."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.removal import blocking_of, box, hook_in_ring, ring
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.removal import check_removal_order
from amprep.checks.packing.volumes_placed import check_packing
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.removal.order import find_removal_order
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Packing,
    PackingProblem,
    Placement,
    Stop,
    Unplaced,
)
from amprep.repacking.interlocking import free_locked_items


def problem_of(solids, size, **rules):
    items = tuple(Item(k, 0, volume_of_solid(solid), float(solid.volume())) for k, solid in enumerate(solids))
    return PackingProblem(items, BuildVolume(np.array(size, float)), interlocking="forbid", **rules)


def at(item, shift):
    return Placement(item, np.eye(3), np.array(shift, float))


def placed(problem, build):
    meshes = [problem.items[each.item].volume.mesh.moved(each.matrix) for each in build]
    return [as_manifold(mesh.vertices, mesh.triangles) for mesh in meshes]


def judge(problem, packing):
    """Hold a packing to the rules of the problem, and each build to a removal order without locked groups."""
    assert check_packing(problem, packing) == []
    for build in packing.builds:
        solids = placed(problem, build)
        order = find_removal_order(blocking_of(solids))
        assert order.locked == ()
        assert check_removal_order(solids, [str(k) for k in range(len(solids))], order, 0.7) == []


def linked(size, **rules):
    """Three links of a chain and a slab, packed with the chain in one piece."""
    links = [ring((0, 14 * k, 0), "xz"[k % 2]) for k in range(3)]
    solids = [*links, box((0, 0, 0), (10, 30, 4))]
    problem = problem_of(solids, size, clearance=0.5, **rules)
    build = (*(at(k, (13, 13, 13)) for k in range(3)), at(3, (27, 1, 1)))
    bound = 1.0 if problem.objective == "builds" else None
    return problem, Packing((build,), status="optimal" if bound else "feasible", bound=bound)


@pytest.mark.parametrize("objective", ["builds", "height"])
def test_links_of_a_chain_are_placed_apart(objective):
    problem, packing = linked((60, 60, 60), objective=objective)
    freed = free_locked_items(problem, packing, Stop())
    judge(problem, freed.packing)
    assert 1 <= len(freed.moved) <= 2
    assert len(freed.packing.builds) == 1
    assert freed.packing.unplaced == ()


def pair(objective):
    """Two linked rings in a build volume that holds them only so."""
    problem = problem_of(hook_in_ring(), (25, 35, 25), clearance=0.5, objective=objective)
    return problem, Packing(((at(0, (12.5, 12.5, 12.5)), at(1, (12.5, 12.5, 12.5))),), status="feasible")


def test_a_new_build_is_opened_where_no_room_is_left():
    problem, packing = pair("builds")
    assert check_packing(problem, packing) == []
    freed = free_locked_items(problem, replace(packing, status="optimal", bound=1.0), Stop())
    judge(problem, freed.packing)
    assert len(freed.packing.builds) == 2
    assert freed.packing.status == "feasible"


def test_in_one_build_parts_without_room_are_unplaced():
    problem, packing = pair("fill")
    freed = free_locked_items(problem, packing, Stop())
    judge(problem, freed.packing)
    assert [(entry.item, entry.reason) for entry in freed.packing.unplaced] == [
        (freed.moved[0], "no room left")
    ]


def test_fixed_parts_stay_and_the_others_leave_them():
    problem, packing = linked((60, 60, 60))
    first = packing.builds[0]
    problem = PackingProblem(problem.items, problem.space, fixed=(first[0], first[2]), clearance=0.5)
    freed = free_locked_items(problem, packing, Stop())
    judge(problem, freed.packing)
    assert freed.moved == (1,)


def test_a_round_plate_and_forbidden_zones_are_respected():
    problem, packing = linked((70, 70, 60), objective="height")
    zones = np.array([[50.0, 44.0, 0.0]]), np.array([[60.0, 54.0, 60.0]])
    space = BuildVolume(np.array([70.0, 70.0, 60.0]), "cylinder", *zones)
    inside = tuple(
        Placement(each.item, each.rotation, each.translation + [10, 10, 0]) for each in packing.builds[0]
    )
    problem = PackingProblem(problem.items, space, "height", clearance=0.5)
    freed = free_locked_items(problem, Packing((inside,)), Stop())
    assert freed.moved
    judge(problem, freed.packing)


def test_packings_of_single_boxes_are_returned_as_they_are():
    cube = Boxes(np.zeros((1, 3)), np.full((1, 3), 10.0))
    items = tuple(Item(0, k, cube, 1.0) for k in range(27))
    problem = PackingProblem(items, BuildVolume(np.full(3, 30.0)), interlocking="forbid")
    cells = np.array(list(np.ndindex(3, 3, 3))) * 10.0
    packing = Packing((tuple(at(k, cell) for k, cell in enumerate(cells)),))
    assert free_locked_items(problem, packing, Stop()).packing is packing


def test_parts_in_hand_at_a_stop_are_out_of_time():
    problem, packing = linked((60, 60, 60))

    class Late(Stop):
        asked = 0

        def __call__(self):
            Late.asked += 1
            return Late.asked > 20

    freed = free_locked_items(problem, packing, Late())
    assert all(isinstance(entry, Unplaced) for entry in freed.packing.unplaced)
    assert check_packing(problem, freed.packing) == []


def test_without_stacking_parts_stay_on_the_plate():
    hook, other = hook_in_ring()
    problem = problem_of([hook, other], (80, 80, 40), clearance=0.5, stacking=False, lift=1.0)
    low = [solid.bounding_box()[2] for solid in (hook, other)]
    assert low[0] < low[1], "the second ring is above the plate, so that only moving it down keeps the rule"
    packing = Packing(((at(0, (13, 13, 1 - low[0])), at(1, (13, 13, 1 - low[0]))),))
    freed = free_locked_items(problem, packing, Stop())
    assert freed.moved
    assert order_of(problem, freed.packing).locked == ()


def order_of(problem, packing):
    (build,) = packing.builds
    return find_removal_order(blocking_of(placed(problem, build)))
