"""The picture of a bounding volume: outlines of its sharp edges on the left, its pieces on the right."""

import numpy as np
import trimesh

from amprep.model import Boxes, Mesh, TurnedVolume
from amprep.model.rotations import quarter_turns
from amprep.model.volume_meshes import box_mesh
from amprep.report.inspection.picture import draw_volume, outlines
from amprep.report.picture.colours import VOLUME, rgb

BOX = box_mesh(np.zeros(3), np.array([30.0, 20.0, 10.0]))


def test_the_outlines_of_a_box_are_its_twelve_edges_and_no_diagonal():
    bars = outlines((BOX,), 0.1)
    assert len(bars.triangles) == 12 * 6
    lengths = np.ptp(bars.vertices.reshape(12, 6, 3), axis=1).max(axis=1)
    assert sorted(np.round(lengths).tolist()) == [10.0] * 4 + [20.0] * 4 + [30.0] * 4
    assert (bars.vertices > BOX.bounds[0] - 0.1).all()
    assert (bars.vertices < BOX.bounds[1] + 0.1).all()


def test_the_picture_shows_part_and_volume_side_by_side(tmp_path):
    from PIL import Image

    turn = quarter_turns()[1]
    turned = BOX.vertices @ turn.T
    made = TurnedVolume(Boxes(turned.min(axis=0)[None] - 5, turned.max(axis=0)[None] + 5), turn)
    draw_volume(BOX, made, "bar", "one box", tmp_path / "bar.png", size=(200, 150))
    pixels = np.asarray(Image.open(tmp_path / "bar.png").convert("RGB")).astype(float) / 255
    assert pixels.shape == (150, 400, 3)
    orange = (pixels[..., 0] - pixels[..., 2]) > 0.5 * (rgb(VOLUME)[0] - rgb(VOLUME)[2])
    assert orange[:, 200:].sum() > 3000, "the volume is a solid on the right"
    assert 100 < orange[:, :200].sum() < 0.5 * orange[:, 200:].sum(), "and lines on the left"


def test_a_fine_sphere_has_no_sharp_edges():
    ball = trimesh.creation.icosphere(subdivisions=3)
    assert len(outlines((Mesh(ball.vertices, ball.faces),), 0.1).triangles) == 0
