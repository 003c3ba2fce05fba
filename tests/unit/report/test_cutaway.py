"""A picture of a part cut open shows its inside."""

import numpy as np
from manifold3d import Manifold
from PIL import Image

from amprep.model import Mesh
from amprep.report.cutaway import draw_cut
from amprep.report.picture import draw_mesh

SIZE = (320, 240)


def mesh_of(solid):
    made = solid.to_mesh()
    return Mesh(made.vert_properties[:, :3], made.tri_verts)


def pixels(path):
    with Image.open(path) as picture:
        assert picture.size == SIZE
        return np.asarray(picture).astype(int)


def test_a_cavity_is_visible_only_in_a_part_that_is_cut_open(tmp_path):
    cube = Manifold.cube((20.0, 20.0, 20.0))
    hollow = cube - Manifold.cube((16.0, 16.0, 16.0)).translate((2.0, 2.0, 2.0))
    for name, solid in (("full", cube), ("hollow", hollow)):
        draw_mesh(mesh_of(solid), tmp_path / f"{name}.png", size=SIZE)
        draw_cut([mesh_of(solid)], tmp_path / f"{name}-cut.png", size=SIZE)
    closed = pixels(tmp_path / "full.png"), pixels(tmp_path / "hollow.png")
    opened = pixels(tmp_path / "full-cut.png"), pixels(tmp_path / "hollow-cut.png")
    assert (closed[0] == closed[1]).all()
    assert (opened[0] != opened[1]).any(axis=2).mean() > 0.02


def test_parts_are_drawn_side_by_side(tmp_path):
    cube = mesh_of(Manifold.cube((20.0, 20.0, 20.0)))
    draw_cut([cube], tmp_path / "one.png", size=SIZE)
    draw_cut([cube, cube, cube], tmp_path / "three.png", size=SIZE)
    one, three = (np.ptp(pixels(tmp_path / f"{name}.png"), axis=2) > 12 for name in ("one", "three"))
    width, height = three.any(axis=0).sum(), three.any(axis=1).sum()
    assert width / height > 1.3 * one.any(axis=0).sum() / one.any(axis=1).sum()
