import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from tests.shared.coverings import boxes_volume, dense_points, in_some_box, part_of

from amprep.geometry.bounding.boxes.turned_k_means import turned_clusters


def around(part, freedom, count=2, restarts=10):
    return turned_clusters(
        part.mesh.vertices,
        part.mesh.triangles,
        count,
        cells=30,
        restarts=restarts,
        freedom=freedom,
        rng=np.random.default_rng(1),
    )


def angle():
    return Manifold.cube([40, 8, 5]) + Manifold.cube([8, 40, 5])


VOLUME = 40 * 40 + 8 * 32 * 5


@pytest.mark.parametrize("degrees", [0, 13, 28, 44])
def test_clusters_of_a_part_that_is_turned_about_z_are_turned_back(degrees):
    part = part_of(angle().rotate([0, 0, degrees]))
    rotation, boxes = around(part, "about-z")
    assert boxes_volume(boxes) == pytest.approx(VOLUME, rel=0.03)
    assert rotation[2].tolist() == [0, 0, 1]
    assert in_some_box(dense_points(part) @ rotation.T, boxes).all()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_clusters_of_a_part_that_is_turned_in_space_are_turned_back(seed):
    turn = Rotation.random(rng=seed).as_matrix()
    part = part_of(angle().transform(np.column_stack((turn, np.zeros(3)))))
    rotation, boxes = around(part, "free")
    assert boxes_volume(boxes) == pytest.approx(VOLUME, rel=0.03)
    assert np.allclose(rotation @ rotation.T, np.eye(3))
    assert np.linalg.det(rotation) == pytest.approx(1)
    assert in_some_box(dense_points(part) @ rotation.T, boxes).all()


def test_a_rotation_that_saves_nothing_is_not_made():
    rotation, _ = around(part_of(Manifold.cube([30, 20, 10])), "free")
    assert rotation.tolist() == np.eye(3).tolist()
