"""Lowest layouts of small instances whose least height is known, judged on the exact shapes."""

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold, OpType
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.volumes_placed import check_packing
from amprep.measures.objective import objective_reached
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Orientations,
    PackingProblem,
    Placement,
    Stop,
    silent,
)
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation import no_fit, pack_separation


def wedge():
    """Half of a cube of side 4, cut along a diagonal plane."""
    points = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [0, 0, 4], [0, 4, 4]])
    return volume_of_solid(Manifold.hull_points(points))


def channel():
    """A block of 6 x 4 x 4 with a channel 2 wide and 3 deep along y, open at the top."""
    return volume_of_solid(Manifold.cube([6, 4, 4]) - Manifold.cube([2, 4, 3]).translate([2, 0, 1]))


def bar():
    return Boxes(np.zeros(3), np.array([1.8, 4, 2.8]))


HALF_TURN = Orientations(matrices=np.array([np.eye(3), np.diag([-1.0, 1, -1])]))


def items_of(*volumes, orientations=None):
    allowed = orientations or Orientations()
    return tuple(Item(k, 0, volume, 1.0, allowed) for k, volume in enumerate(volumes))


def pack(items, size, work=60.0, seed=1, stop=None, **rules):
    problem = PackingProblem(items, BuildVolume(np.array(size, float)), "height", **rules)
    packing = pack_separation(
        problem,
        params=SeparationParams(work=work),
        rng=np.random.default_rng(seed),
        stop=stop or Stop(),
        progress=silent,
    )
    assert check_packing(problem, packing) == []
    return problem, packing, objective_reached(problem, packing)


def test_two_wedges_make_a_cube():
    _, packing, height = pack(items_of(wedge(), wedge(), orientations=HALF_TURN), (4, 4, 50))
    assert not packing.unplaced
    assert height == pytest.approx(4.0, abs=1e-3)


def test_a_bar_goes_into_the_channel_of_a_block():
    _, packing, height = pack(items_of(channel(), bar()), (6, 4, 50))
    assert height == pytest.approx(4.0, abs=1e-3)
    assert packing.bound == pytest.approx(4.0)


@pytest.mark.parametrize("clearance", [0.0, 0.5, 3.0])
def test_curved_and_concave_parts_keep_the_clearance(clearance):
    ball = volume_of_solid(Manifold.sphere(3.0, 12))
    cross = volume_of_solid(
        Manifold.batch_boolean([Manifold.cube([8, 2, 2], True), Manifold.cube([2, 8, 2], True)], OpType.Add)
    )
    size = np.array([16.0, 16, 200]) + 2 * clearance
    items = items_of(ball, ball, cross, cross, wedge(), channel(), orientations=HALF_TURN)
    _, packing, _ = pack(items, size, work=10.0, clearance=clearance, lift=clearance)
    assert not packing.unplaced


def test_the_excess_of_the_pieces_of_each_solid_is_stated():
    ball = volume_of_solid(Manifold.sphere(3.0, 32))
    knee = volume_of_solid(Manifold.cube([6, 2, 2]) + Manifold.cube([2, 2, 6]))
    _, packing, _ = pack(items_of(ball, ball, knee, bar()), (16, 16, 99), work=5.0)
    assert set(packing.excess) == {0, 1, 2}, "a box is packed as it is"
    assert packing.excess[2] == pytest.approx(0.0, abs=1e-4)
    hull = Manifold.hull_points(ball.mesh.vertices).volume()
    assert packing.excess[0] == packing.excess[1]
    assert hull / ball.mesh.signed_volume - 1.0 - 1e-9 <= packing.excess[0] < 0.2


@pytest.mark.parametrize("clearance", [0.0, 0.5, 3.0])
def test_layouts_found_with_voxels_keep_the_clearance(clearance, monkeypatch):
    monkeypatch.setattr(no_fit, "MOST_CORNER_PAIRS", 0)
    ball = volume_of_solid(Manifold.sphere(5.0, 16))
    ring = volume_of_solid(Manifold.revolve(CrossSection.circle(1.5, 8).translate([6, 0]), 16))
    bracket = volume_of_solid(
        Manifold.cube([12, 3, 9]) + Manifold.cube([12, 10, 3]) - Manifold.cylinder(20, 2.0)
    )
    size = np.array([24.0, 24, 400]) + 2 * clearance
    items = items_of(*[ball] * 3, *[ring] * 3, *[bracket] * 3, orientations=HALF_TURN)
    _, packing, _ = pack(items, size, work=15.0, clearance=clearance, lift=clearance)
    assert not packing.unplaced


def test_the_tallest_curved_part_is_a_bound_that_is_met_in_spite_of_the_rounding_of_pieces():
    """The check of claims refuses a bound above the height, and an optimal packing above its bound."""
    tower = volume_of_solid(Manifold.cylinder(31.7, 3.1, 4.3, 48) - Manifold.cylinder(40.0, 2.2, 2.2, 48))
    _, packing, height = pack(
        items_of(tower, volume_of_solid(Manifold.sphere(5.0, 32))), (30, 30, 99), work=5.0
    )
    assert packing.status == "optimal"
    assert height == pytest.approx(31.7, abs=1e-6)


def test_fixed_parts_and_zones_are_avoided_and_the_bound_counts_them():
    fixed = (Placement(0, np.eye(3), np.array([0.0, 0, 5])),)
    space = BuildVolume(np.array([6.0, 6, 50]), "box", np.array([[4.0, 4, 0]]), np.array([[6.0, 6, 50]]))
    problem = PackingProblem(items_of(channel(), bar(), bar()), space, "height", fixed)
    packing = pack_separation(
        problem,
        params=SeparationParams(work=20.0),
        rng=np.random.default_rng(0),
        stop=Stop(),
        progress=silent,
    )
    assert check_packing(problem, packing) == []
    assert packing.bound == pytest.approx(9.0)
    assert packing.status == "optimal"


def test_the_height_of_the_lowest_shape_is_a_bound():
    plank = Boxes(np.zeros(3), np.array([1.0, 5, 9]))
    _, packing, height = pack(
        items_of(plank, orientations=Orientations(matrices=axis_rotations())), (9, 9, 20)
    )
    assert height == packing.bound == 1.0
    assert packing.status == "optimal"


def test_what_is_higher_than_the_build_volume_is_left_out():
    cube = Boxes(np.zeros(3), np.full(3, 4.0))
    _, packing, height = pack(items_of(cube, cube, cube), (4, 4, 9), work=5.0)
    assert len(packing.unplaced) == 1
    assert packing.unplaced[0].reason == "no room left"
    assert height == pytest.approx(8.0, abs=1e-3)


def test_the_same_seed_gives_the_same_layout():
    items = items_of(*[wedge()] * 4, *[channel()] * 2)
    one, other = (pack(items, (9, 9, 50), work=5.0)[1] for _ in range(2))
    assert [p.matrix.tolist() for p in one.builds[0]] == [p.matrix.tolist() for p in other.builds[0]]


def test_without_time_for_the_shapes_their_boxes_are_packed():
    items = items_of(*[wedge()] * 4, *[channel()] * 2)
    _, packing, height = pack(items, (9, 9, 50), stop=Stop.after(0.0))
    assert not packing.unplaced
    assert packing.stop_reason == "time limit"
    assert packing.bound < height <= 12.0
    assert packing.excess == {}


def test_the_search_ends_when_poles_that_are_too_long_to_lie_stand():
    pole = Boxes(np.zeros(3), np.array([2.0, 2.0, 14.0]))
    turns = Orientations("list", axis_rotations())
    _, packing, height = pack(items_of(pole, pole, orientations=turns), (9, 9, 40))
    assert (packing.status, packing.stop_reason) == ("optimal", "finished")
    assert height == pytest.approx(14.0)


def test_a_bar_that_stands_lowest_between_zones_stays_on_the_plate():
    """Lying on the zones it would be higher, and a lower build has room for neither position."""
    zones = np.array([[3.5, 0, 0, 12, 12, 9.5], [0, 3.5, 0, 12, 12, 9.5]])
    space = BuildVolume(np.array([12.0, 12.0, 30.0]), "box", zones[:, :3], zones[:, 3:])
    turns = Orientations("list", axis_rotations())
    tall = Item(0, 0, Boxes(np.zeros(3), np.array([2.0, 2.0, 10.0])), 1.0, turns)
    problem = PackingProblem((tall,), space, "height")
    rng = np.random.default_rng(1)
    packing = pack_separation(
        problem, params=SeparationParams(work=10.0), rng=rng, stop=Stop(), progress=silent
    )
    assert check_packing(problem, packing) == []
    assert objective_reached(problem, packing) == pytest.approx(10.0, abs=1e-6)
