"""Of parts that boxes cover badly, `auto` packs enclosing boxes first and then gains with the true shapes."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.checks.packing.volumes_placed import check_packing
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Mesh,
    Orientations,
    PackingProblem,
    Placement,
    Solid,
    Stop,
    silent,
)
from amprep.model.rotations import quarter_turns
from amprep.plugins.packers import plates, separation
from amprep.plugins.packers.auto import pack_auto
from amprep.plugins.packers.params import AutoParams

TURNS = Orientations(matrices=quarter_turns())


def wedge(x=40.0, y=40.0, z=20.0):
    """Half of a box, cut along a vertical plane through two edges: two of them fill the box."""
    corners = np.array([[0, 0, 0], [x, 0, 0], [0, y, 0], [0, 0, z], [x, 0, z], [0, y, z]])
    triangles = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
    return Mesh(corners, np.array(triangles))


WEDGE = Solid(wedge())


def problem(count, room, objective="builds", *, volume=WEDGE, **rules):
    items = tuple(Item(0, copy, volume, 1.0, TURNS, exact=True) for copy in range(count))
    return PackingProblem(items, BuildVolume(np.array(room, float)), objective, **rules)


def packed(given, stop=None, **params):
    chosen = AutoParams(**{"separation": 60.0, **params})
    return pack_auto(given, params=chosen, rng=np.random.default_rng(1), stop=stop or Stop(), progress=silent)


def placed_solids(given, build):
    return [
        as_manifold(*given.items[p.item].volume.mesh.arrays).transform(p.matrix[:3].tolist()) for p in build
    ]


def overlap(given, packing):
    """The greatest volume (mm3) that two placed meshes share."""
    shared = [0.0]
    for build in packing.builds:
        solids = placed_solids(given, build)
        shared += [(a ^ b).volume() for i, a in enumerate(solids) for b in solids[:i]]
    return max(shared)


def test_two_wedges_go_into_one_build_where_their_boxes_need_two():
    given = problem(2, (43, 43, 21))
    packing = packed(given)
    assert [len(build) for build in packing.builds] == [2]
    assert overlap(given, packing) < 1e-2
    assert check_packing(given, packing) == []
    assert (packing.status, packing.bound, packing.bound_for) == ("optimal", 1.0, "shapes")
    assert [(step.method, step.reached) for step in packing.steps][:2] == [
        ("enclosing boxes", 2.0),
        ("true shapes", 1.0),
    ]


def test_nothing_but_boxes_is_packed_where_they_are_proved_best_for_the_shapes(monkeypatch):
    monkeypatch.setattr(separation, "pack_separation", None)
    packing = packed(problem(4, (90, 90, 50)))
    assert (packing.status, packing.bound) == ("optimal", 1.0)
    assert packing.steps[0].method == "enclosing boxes"
    assert packing.excess == {}
    low = packed(problem(4, (90, 90, 50), "height"))
    assert (low.status, low.bound) == ("optimal", pytest.approx(20.0))
    assert len(low.steps) == 1


def test_true_shapes_are_not_tried_for_a_part_whose_box_is_too_large(monkeypatch):
    monkeypatch.setattr(separation, "pack_separation", None)
    given = problem(2, (90, 90, 25))
    high = Item(1, 0, Solid(wedge(z=30.0)), 1.0, TURNS, exact=True)
    packing = packed(PackingProblem((*given.items, high), given.space))
    assert [each.reason for each in packing.unplaced] == ["too large"]
    assert packing.status == "infeasible"


def test_a_build_that_need_not_be_high_is_low():
    given = problem(2, (43, 43, 100))
    packing = packed(given)
    assert [step.height for step in packing.steps] == [pytest.approx(40.0), pytest.approx(20.0, abs=0.1)]
    assert packing.steps[-1].method == "lower builds"
    assert packing.excess == {0: pytest.approx(0.0, abs=1e-4), 1: pytest.approx(0.0, abs=1e-4)}
    assert overlap(given, packing) < 1e-2
    assert check_packing(given, packing) == []


def test_the_lowest_build_of_true_shapes_is_lower_than_that_of_boxes():
    given = problem(2, (43, 43, 100), "height")
    packing = packed(given)
    assert packing.steps[0].reached == pytest.approx(40.0)
    assert packing.steps[-1].reached == pytest.approx(20.0, abs=0.1)


def test_a_filling_of_true_shapes_has_more_value_than_one_of_boxes():
    packing = packed(problem(2, (43, 43, 21), "fill"))
    assert [step.reached for step in packing.steps] == [1.0, 2.0]
    assert packing.status == "optimal"


def test_two_wedges_share_a_plate_on_which_nothing_is_stacked():
    given = problem(2, (43, 43, 100), stacking=False)
    packing = packed(given, plates=200.0)
    assert [step.reached for step in packing.steps] == [2.0, 1.0]
    assert packing.status == "optimal"
    assert overlap(given, packing) < 1e-2
    assert check_packing(given, packing) == []


@pytest.mark.parametrize("stacking", [False, True])
def test_boxes_alone_are_packed_without_work_for_true_shapes(monkeypatch, stacking):
    monkeypatch.setattr(separation, "pack_separation", None)
    monkeypatch.setattr(plates, "pack_plates", None)
    packing = packed(problem(2, (43, 43, 21), stacking=stacking), separation=0.0, plates=0.0)
    assert (len(packing.builds), packing.bound, packing.status) == (2, 1.0, "feasible")


def test_parts_that_may_be_turned_by_any_angle_are_packed_as_boxes_in_quarter_turns():
    items = tuple(Item(0, copy, WEDGE, 1.0, Orientations("about-z"), exact=True) for copy in range(4))
    packing = packed(PackingProblem(items, BuildVolume(np.array([90.0, 90, 50]))))
    assert (len(packing.builds), packing.bound_for) == (1, "shapes")
    box = Boxes(np.zeros((1, 3)), np.array([[80.0, 40, 20]]))
    turned = Item(0, 0, box, 1.0, Orientations("about-z"), exact=True)
    packing = packed(PackingProblem((turned,), BuildVolume(np.array([45.0, 90, 50]))))
    assert (len(packing.builds), packing.bound_for) == (1, "volumes")


def test_a_bound_is_for_the_volumes_where_they_are_not_the_parts():
    items = tuple(Item(0, copy, WEDGE, 1.0, TURNS) for copy in range(2))
    packing = packed(PackingProblem(items, BuildVolume(np.array([90.0, 90, 50]))))
    assert packing.bound_for == "volumes"


def test_boxes_are_packed_as_before_and_without_steps():
    box = Boxes(np.zeros((1, 3)), np.array([[40.0, 40, 20]]))
    packing = packed(problem(3, (43, 43, 100), volume=box))
    assert packing.steps == ()
    assert len(packing.builds) == 1


def test_fixed_parts_stay_and_are_avoided():
    given = problem(3, (43, 43, 42))
    fixed = (Placement(0, np.eye(3), np.array([1.0, 1.0, 0.0])),)
    given = PackingProblem(given.items, given.space, fixed=fixed)
    packing = packed(given)
    (kept,) = [p for p in packing.builds[0] if p.item == 0]
    np.testing.assert_array_equal(kept.matrix, fixed[0].matrix)
    assert overlap(given, packing) < 1e-2
    assert check_packing(given, packing) == []


def test_a_packer_that_is_stopped_at_once_places_what_it_can():
    given = problem(4, (43, 43, 21))
    assert check_packing(given, packed(given, Stop.after(0.0))) == []


def test_the_same_seed_gives_the_same_packing():
    one, other = packed(problem(3, (43, 43, 42))), packed(problem(3, (43, 43, 42)))
    assert [[p.matrix.tolist() for p in b] for b in one.builds] == [
        [p.matrix.tolist() for p in b] for b in other.builds
    ]


def test_the_wedge_is_a_solid_of_half_the_box():
    assert Manifold.volume(as_manifold(*wedge().arrays)) == pytest.approx(40 * 40 * 20 / 2)
