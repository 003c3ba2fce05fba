"""What of a surface does not depend on the direction that points up."""

import numpy as np
import trimesh

from amprep.geometry.orientation.surface import turnable_surface


def test_neighbours_are_mutual_and_share_the_side():
    ball = trimesh.creation.icosphere(2)
    surface = turnable_surface(ball.vertices, ball.faces)
    for face in range(len(surface.triangles)):
        for side in range(3):
            other, back = divmod(int(surface.beyond[face, side]), 3)
            assert surface.beyond[other, back] == 3 * face + side
            own = {surface.triangles[face, side], surface.triangles[face, (side + 1) % 3]}
            assert own == {surface.triangles[other, back], surface.triangles[other, (back + 1) % 3]}


def test_edges_of_a_box_are_sharp_and_diagonals_are_straight():
    box = trimesh.creation.box((4, 2, 6))
    surface = turnable_surface(box.vertices, box.faces)
    assert len(surface.edges) == 12
    assert surface.straight.sum() == 12, "both sides of six diagonals"
    assert np.allclose(np.linalg.norm(surface.rays, axis=2), 1.0)
    assert np.isclose(surface.areas.sum(), box.area)


def test_an_inner_corner_is_straight_and_no_knife_edge():
    bracket = trimesh.boolean.union(
        [
            trimesh.creation.box(bounds=[[0, 0, 0], [4, 1, 1]]),
            trimesh.creation.box(bounds=[[0, 0, 0], [1, 1, 4]]),
        ]
    )
    surface = turnable_surface(bracket.vertices, bracket.faces)
    inner = (surface.points[surface.edges] == [1, 0, 1])[..., [0, 2]].all(axis=2).all(axis=1)
    assert not inner.any()


def test_an_open_side_leads_nowhere():
    surface = turnable_surface(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]]))
    assert surface.beyond.tolist() == [[-1, -1, -1]]
