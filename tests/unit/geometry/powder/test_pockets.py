"""Trapped powder, drain holes and contacts with parts: cases known by hand."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.geometry.powder.drain_holes import find_drain_holes
from amprep.geometry.powder.pockets import find_pockets
from amprep.geometry.supports.contact_area import measure_contact


def box(size, corner):
    return Manifold.cube(size).translate(corner)


def arrays(solid):
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)


CASE = box((6, 5, 7), (0, 0, 0)) - box((4, 3, 5), (1, 1, 1))
PART = box((12, 12, 2), (-3, -3, 8))


def test_a_closed_box_traps_exactly_its_inside():
    (pocket,) = find_pockets([arrays(CASE)], [], diameter=0.2)
    assert pocket.closed
    assert pocket.volume == pytest.approx(60.0, rel=1e-5)
    np.testing.assert_allclose([pocket.lo, pocket.hi], [(1, 1, 1), (5, 4, 6)], atol=0.11)
    assert (np.array(pocket.lo) < pocket.point).all()
    assert (np.array(pocket.hi) > pocket.point).all()


def test_four_walls_between_the_plate_and_a_part_trap_the_powder_between_them():
    walls = box((6, 5, 8), (0, 0, 0)) - box((4, 3, 9), (1, 1, -0.5))
    (pocket,) = find_pockets([arrays(walls)], [arrays(PART)], diameter=0.2)
    assert pocket.closed
    assert pocket.volume == pytest.approx(4 * 3 * 8, rel=1e-5)
    assert find_pockets([arrays(walls)], [], diameter=0.2) == []


@pytest.mark.parametrize(("width", "count"), [(0.15, 1), (0.35, 0)])
@pytest.mark.parametrize("turn", [0, 90])
def test_a_slit_lets_powder_out_when_it_is_wider_than_the_hole(width, count, turn):
    slit = CASE - box((2, width, 3), (4.5, 2, 2))
    found = find_pockets([arrays(slit.rotate((0, 0, turn)))], [], diameter=0.2)
    assert len(found) == count
    for pocket in found:
        assert not pocket.closed
        assert pocket.volume == pytest.approx(60.0, rel=0.02)


@pytest.mark.parametrize(("width", "count"), [(0.13, 1), (0.35, 0)])
def test_a_slit_along_a_diagonal_closes_when_it_is_narrower_than_seven_tenths_of_the_hole(width, count):
    slit = CASE - box((2, width, 3), (4.5, 2, 2))
    assert len(find_pockets([arrays(slit.rotate((0, 0, 45)))], [], diameter=0.2)) == count


@pytest.mark.parametrize(("side", "count"), [(0.25, 0), (0.45, 1)])
@pytest.mark.parametrize("turn", [0, 45])
def test_a_cavity_hardly_wider_than_the_ball_is_no_pocket(side, count, turn):
    block = box((4, 4, 4), (-2, -2, 0)) - box((side, side, 1), (-side / 2, -side / 2, 1)).rotate((0, 0, turn))
    assert len(find_pockets([arrays(block)], [], diameter=0.2)) == count


@pytest.mark.parametrize(("height", "count"), [(0.19, 1), (0.21, 0)])
def test_a_level_slit_is_measured_without_steps(height, count):
    slit = CASE - box((2, 2, height), (4.5, 1.5, 3))
    assert len(find_pockets([arrays(slit)], [], diameter=0.2)) == count


def test_a_cavity_of_a_part_itself_does_not_count():
    hollow = box((8, 8, 8), (0, 0, 4)) - box((2, 2, 2), (3, 3, 7))
    post = box((1, 1, 4.1), (3.5, 3.5, 0))
    assert find_pockets([arrays(post)], [arrays(hollow)], diameter=0.2) == []


def test_two_chambers_with_a_door_are_one_pocket_and_without_it_two():
    walls = CASE + box((0.5, 3, 5), (2.75, 1, 1))
    assert len(find_pockets([arrays(walls)], [], diameter=0.2)) == 2
    door = walls - box((1, 1, 1), (2.5, 2, 2))
    (pocket,) = find_pockets([arrays(door)], [], diameter=0.2)
    assert pocket.volume == pytest.approx(60 - 0.5 * 15 + 0.5, rel=2e-2)


def test_a_drain_hole_is_cut_where_it_is_shortest_and_never_through_a_part():
    (hole,) = find_drain_holes(arrays(CASE), [], diameter=0.2)
    cut_drain_holes = CASE - box((hole[1] - hole[0]).tolist(), hole[0].tolist())
    assert find_pockets([arrays(cut_drain_holes)], [], diameter=0.2) == []
    assert (hole[0] > (-1, -1, 0)).all()
    shell = box((8, 7, 9), (-1, -1, -1)) - box((6, 5, 7), (0, 0, 0))
    assert find_drain_holes(arrays(CASE), [arrays(shell)], diameter=0.2) == []


def test_the_same_solids_give_the_same_pockets_wherever_they_stand():
    here = find_pockets([arrays(CASE)], [], diameter=0.2)
    there = find_pockets([arrays(CASE.translate((100.03, 57.77, 0)))], [], diameter=0.2)
    assert there[0].volume == pytest.approx(here[0].volume, rel=1e-5)


def test_a_column_of_2_by_2_has_4_mm2_of_contact_in_one_patch():
    column = box((2, 2, 10), (0, 0, 0))
    contact = measure_contact(arrays(column), arrays(box((20, 20, 5), (-9, -9, 9.9))))
    assert contact.area == pytest.approx(4.0, abs=1e-9)
    assert contact.patches == 1


def test_the_contact_with_a_slope_is_larger_than_its_plan():
    slope = box((20, 20, 5), (-10, -10, 0)).rotate((0, 30, 0)).translate((0, 0, 9.0))
    contact = measure_contact(arrays(box((2, 2, 10), (-1, -1, 0))), arrays(slope))
    assert contact.area == pytest.approx(4.0 / np.cos(np.radians(30)), rel=1e-9)


def test_two_posts_have_two_contacts_and_a_post_that_stays_below_has_none():
    posts = box((2, 2, 10), (0, 0, 0)) + box((2, 2, 10), (5, 0, 0))
    plate = arrays(box((20, 20, 5), (-9, -9, 9.9)))
    assert measure_contact(arrays(posts), plate).patches == 2
    assert measure_contact(arrays(box((2, 2, 9), (0, 0, 0))), plate) == (0.0, 0)
