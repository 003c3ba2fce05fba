"""Parts that may be turned about z are offered turns in which no long edge meets the blade; others stay as they are."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from tests.shared.builds import box_mesh
from tests.shared.examples import examples
from tests.shared.solids import mesh_of

from amprep.measures.printing.blade_edges import BladeRules, measure_blade_edges
from amprep.measures.printing.blade_turns import turns_off_blade
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart
from amprep.model.rotations import parse_rotations

LISTS = frozenset({"fixed", "axis", "list"})
ALL = LISTS | {"about-z", "free"}
BRICK = box_mesh((0, 0, 0), (30, 20, 15))


def part_of(mesh, words):
    return Part("part", mesh, mesh.signed_volume, orientations=parse_rotations(words))


def meets(part, matrix, rules):
    pose = np.eye(4)
    pose[:3, :3] = matrix
    build = Build(BuildSettings("none", BuildVolume(np.full(3, 200.0))), (PlacedPart("part", part, pose),))
    return len(measure_blade_edges(build, rules)) > 0


def turns_deg(orientations):
    turns = np.degrees(np.arctan2(orientations.matrices[:, 1, 0], orientations.matrices[:, 0, 0]))
    return sorted(np.round(turns % 360, 6).tolist())


@pytest.mark.parametrize("recoater", [0.0, 30.0, 90.0])
def test_a_brick_that_may_turn_by_any_angle_is_turned_by_five_to_fifteen_degrees(recoater):
    rules, part = BladeRules(recoater_deg=recoater), part_of(BRICK, "about-z")
    found = turns_off_blade(part, rules, LISTS)
    assert found.freedom == "list"
    assert not any(meets(part, matrix, rules) for matrix in found.matrices)
    from_quarter = np.array([(turn + 45) % 90 - 45 for turn in turns_deg(found)])
    assert (np.abs(from_quarter) <= 15.0).all()
    assert len(found.matrices) == (8 if recoater in (0.0, 90.0) else 4)


def test_steps_that_bring_an_edge_to_the_blade_are_left_out():
    found = turns_off_blade(part_of(BRICK, "z15"), BladeRules(), LISTS)
    assert turns_deg(found) == [turn for turn in range(0, 360, 15) if turn % 90]


def test_a_part_for_which_no_turn_is_better_keeps_its_own():
    for words in ("none", "z90"):
        part = part_of(BRICK, words)
        assert turns_off_blade(part, BladeRules(), LISTS) is part.orientations
    star = mesh_of(Manifold.cylinder(20, 80, 80, 40))
    part = part_of(star, "about-z")
    assert turns_off_blade(part, BladeRules(), LISTS) is part.orientations


def test_a_round_part_and_a_packer_without_lists_change_nothing():
    ball = part_of(mesh_of(Manifold.sphere(20, 48)), "about-z")
    assert turns_off_blade(ball, BladeRules(), ALL) is ball.orientations
    brick = part_of(BRICK, "about-z")
    assert turns_off_blade(brick, BladeRules(), frozenset({"fixed", "axis"})) is brick.orientations


def test_any_rotation_stays_free_for_packers_that_can_handle_it_and_is_listed_for_others():
    part = part_of(BRICK, "free")
    assert turns_off_blade(part, BladeRules(), ALL) is part.orientations
    listed = turns_off_blade(part, BladeRules(), LISTS)
    assert len({tuple(np.round(row, 6)) for row in listed.matrices[:, 2]}) == 6, "any axis may point up"
    assert not any(meets(part, matrix, BladeRules()) for matrix in listed.matrices)


def test_a_list_is_filtered_for_each_direction_that_points_up():
    part = part_of(BRICK, "up-xz")
    tilted = parse_rotations("z15").matrices @ part.orientations.matrices[4]
    both = replace(part, orientations=replace(part.orientations, matrices=np.concatenate(
        [part.orientations.matrices[:1], tilted])))  # fmt: skip
    found = turns_off_blade(both, BladeRules(), LISTS).matrices
    np.testing.assert_allclose(
        found[0], np.eye(3), err_msg="the only one with z up stays, although it meets the blade"
    )
    assert len(found) == 1 + 20
    assert not any(meets(both, matrix, BladeRules()) for matrix in found[1:])


@given(seed=st.integers(0, 10**6))
@examples(20)
def test_what_is_offered_is_allowed_and_keeps_off_the_blade_if_anything_does(seed):
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
    outline = np.column_stack([np.cos(angles), np.sin(angles)]) * 20.0
    part = part_of(mesh_of(Manifold.extrude(CrossSection([outline]), 8.0)), "z10 except 40-80")
    rules = BladeRules(recoater_deg=float(rng.uniform(0, 360)), edge_mm=9.0)
    every = part.orientations.matrices
    good = [matrix for matrix in every if not meets(part, matrix, rules)]
    np.testing.assert_array_equal(
        turns_off_blade(part, rules, LISTS).matrices, np.array(good) if good else every
    )
