import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.coverings import dense_points, in_some_box, part_of, solid_of

from amprep.geometry.bounding.boxes.cells import cells_of, in_mm, snapped

PARTS = {
    "ball": lambda: Manifold.sphere(10, 24).rotate([10, 20, 30]),
    "turned angle": lambda: (Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20])).rotate([15, 25, 35]),
    "far away": lambda: Manifold.cylinder(20, 3, 8).translate([-900.1, 700.3, 50.7]),
}


@pytest.mark.parametrize("name", PARTS)
def test_each_tight_box_is_in_its_cell_and_encloses_what_samples_find_there(name):
    part = part_of(PARTS[name]())
    grid = cells_of(part.mesh.vertices, part.mesh.triangles, 6)
    shape = np.array(grid.tight.shape[:3])
    assert max(shape) == 6
    number = np.argwhere(grid.met)
    low = grid.origin + number * grid.size
    assert (grid.items[:, :3] >= low - 1e-9).all()
    assert (grid.items[:, 3:] <= low + grid.size + 1e-9).all()
    points = dense_points(part, 60)
    cell = np.clip(((points - grid.origin) / grid.size).astype(int), 0, shape - 1)
    tight = grid.tight[tuple(cell.T)]
    inside = ((points >= tight[:, :3] - 1e-9) & (points <= tight[:, 3:] + 1e-9)).all(axis=1)
    assert inside.all()
    sampled = np.full_like(grid.tight, np.inf)
    sampled[..., 3:] = -np.inf
    np.minimum.at(sampled[..., :3], tuple(cell.T), points)
    np.maximum.at(sampled[..., 3:], tuple(cell.T), points)
    found = grid.met & (sampled[..., 0] <= sampled[..., 3])
    assert np.median(np.abs(sampled[found] - grid.tight[found])) < 0.05 * grid.size.max()


def test_a_face_in_a_plane_of_the_grid_is_in_the_cell_of_the_material():
    part = solid_of([[0, 0, 0, 10, 10, 2], [0, 0, 0, 2, 10, 10]])
    grid = cells_of(part.mesh.vertices, part.mesh.triangles, 5)
    assert grid.met[1:, :, 1:].sum() == 0
    assert in_some_box(dense_points(part), grid.items).all()


def test_blocks_contain_the_boxes_that_they_are_snapped_to():
    part = solid_of([[0, 0, 0, 10, 7, 3]])
    grid = cells_of(part.mesh.vertices, part.mesh.triangles, 10)
    boxes = np.array([[0.5, 0, 0, 3.2, 7, 1], [9, 6.9, 2, 10, 7, 3]])
    blocks = snapped(grid, boxes)
    assert blocks.tolist() == [[0, 0, 0, 4, 7, 1], [9, 6, 2, 10, 7, 3]]
    assert in_mm(grid, blocks).tolist() == [[0, 0, 0, 4, 7, 1], [9, 6, 2, 10, 7, 3]]


def test_a_flat_surface_is_one_cell_high():
    vertices = np.array([[0.0, 0, 5], [9, 0, 5], [0, 3, 5]])
    grid = cells_of(vertices, np.array([[0, 1, 2]]), 9)
    assert grid.tight.shape == (9, 3, 1, 6)
    assert (grid.items[:, [2, 5]] == 5).all()
