"""Centre of mass and tipping angle of solids with known ones."""

import numpy as np
import pytest
import trimesh

from amprep.geometry.orientation.tipping import centre_of_mass, tipping_angles

UP = np.array([[0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    "solid",
    [trimesh.creation.box((4, 2, 6)), trimesh.creation.cone(3, 8), trimesh.creation.icosphere(2)],
    ids=["box", "cone", "ball"],
)
def test_the_centre_of_mass_is_that_of_the_solid(solid):
    solid.apply_translation((5, -3, 2))
    assert centre_of_mass(solid.triangles) == pytest.approx(solid.center_mass)


def test_an_open_surface_has_the_centre_of_its_area():
    square = np.array([[[0, 0, 1], [2, 0, 1], [2, 2, 1]], [[0, 0, 1], [2, 2, 1], [0, 2, 1.0]]])
    flat = np.concatenate([square, square[:, ::-1]])
    assert centre_of_mass(flat) == pytest.approx([1, 1, 1])


def test_a_box_tips_over_its_nearest_side():
    box = trimesh.creation.box((4, 2, 6))
    # the side y = -1 is 1 mm from the centre in plan, which is 3 mm high
    assert tipping_angles(box.vertices, np.zeros(3), UP, 0.1) == pytest.approx([np.degrees(np.arctan(1 / 3))])
    sideways = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    expected = np.degrees(np.arctan([1 / 2, 2 / 1]))
    assert tipping_angles(box.vertices, np.zeros(3), sideways, 0.1) == pytest.approx(expected)


def test_what_stands_on_an_edge_or_leans_too_far_does_not_stand():
    box = trimesh.creation.box((4, 2, 6))
    on_edge = np.array([[0.0, 0.6, 0.8]])
    assert tipping_angles(box.vertices, np.zeros(3), on_edge, 0.01).tolist() == [0.0]
    assert tipping_angles(box.vertices, np.array([2.5, 0.0, 0.0]), UP, 0.1).tolist() == [0.0]


@pytest.mark.parametrize("seed", range(4))
def test_the_margin_is_that_of_the_convex_hull(seed):
    from scipy.spatial import ConvexHull

    random = np.random.default_rng(seed)
    points = np.column_stack([random.normal(size=(40, 2)), np.zeros(40)])
    points = np.concatenate([points, [[0.0, 0.0, 5.0]]])
    hull = ConvexHull(points[:40, :2])
    margin = -(hull.equations[:, :2] @ [0.1, 0.0] + hull.equations[:, 2]).max()
    expected = np.degrees(np.arctan2(max(margin, 0.0), 2.0))
    assert tipping_angles(points, np.array([0.1, 0.0, 2.0]), UP, 0.1) == pytest.approx([expected])
