"""Points of overhangs near contacts, on shapes for which the answer is plain."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.model import BuildSettings, BuildVolume, Mesh, SupportBody
from amprep.overhangs.contacts import find_held, is_near

SLAB = box_mesh((0, 0, 10), (20, 20, 3))
LINE = np.array([(x, 10.0, 10.0) for x in np.arange(0.0, 20.25, 0.25)])
"""Points along the middle of the slab's underside."""


def held(*bodies, reach=1.4):
    return LINE[find_held(LINE, SLAB, bodies, settings(reach), 0.5), 0]


def settings(reach):
    return BuildSettings("b", BuildVolume([60, 60, 60]), reach=reach)


def test_a_post_holds_the_points_above_it_and_within_reach():
    post = SupportBody("post", box_mesh((8, 8, 0), (4, 4, 10.1)), (0,))
    assert (held(post).min(), held(post).max()) == (6.75, 13.25)
    assert (held(post, reach=3.1).min(), held(post, reach=3.1).max()) == (5.0, 15.0)


def test_each_body_holds_as_far_as_its_own_reach():
    near = SupportBody("near", box_mesh((2, 8, 0), (1, 4, 10.1)), (0,), reach=0.6)
    usual = SupportBody("usual", box_mesh((10, 8, 0), (1, 4, 10.1)), (0,))
    for bodies in ((near, usual), (usual, near)):
        on = held(*bodies)
        assert on[on < 6].tolist() == [1.5, 1.75, *np.arange(2, 3.25, 0.25), 3.25, 3.5]
        assert (on[on > 6].min(), on.max()) == (8.75, 12.25)


@pytest.mark.parametrize(("top", "is_held"), [(9.9, False), (10.0, True), (10.1, True)])
def test_a_post_that_stops_below_the_face_holds_nothing(top, is_held):
    post = SupportBody("post", box_mesh((8, 8, 0), (4, 4, top)), (0,))
    assert bool(len(held(post))) == is_held


def test_a_post_between_the_sample_points_holds_by_its_edges():
    thin = SupportBody("post", box_mesh((10.1, 10.1, 0), (0.05, 0.05, 10.1)), (0,))
    assert held(thin).min() == pytest.approx(8.75)
    assert held(thin).max() == pytest.approx(11.5)


def test_a_wall_without_thickness_holds_by_its_upper_edge():
    corners = np.array([(10, 0, 0), (10, 20, 0), (10, 20, 10.05), (10, 0, 10.05)], float)
    wall = SupportBody("wall", Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]])), (0,), surface=True)
    assert (held(wall).min(), held(wall).max()) == (8.75, 11.25)


def test_points_on_the_plate_are_held_without_supports():
    points = np.array([(0, 0, 0.0), (0, 0, 0.5), (0, 0, 5.0)])
    assert find_held(points, box_mesh((0, 0, 0), (1, 1, 1)), (), settings(1.0), 0.5).tolist() == [
        True,
        True,
        False,
    ]


def test_near_points_are_those_of_all_pairs():
    rng = np.random.default_rng(0)
    targets, points = rng.random((20, 3)), rng.random((50, 3))
    distance = np.linalg.norm(targets[:, None] - points[None], axis=2).min(axis=0)
    assert (is_near(targets, points, 0.2) == (distance < 0.2)).all()
    assert not is_near(targets[:0], points, 0.2).any()
