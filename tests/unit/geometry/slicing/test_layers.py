"""Layers of bodies, compared with the cross-sections and volumes of manifold3d."""

import numpy as np
import pytest
from manifold3d import CrossSection, FillRule, Manifold
from tests.shared.cli_reader import signed_area

from amprep.geometry.slicing.layers import LayeredBody
from amprep.geometry.slicing.text import groups_text, rows_text


def arrays_of(*solids):
    """Vertices and triangles of solids, one behind the other, not united."""
    vertices, triangles, count = [], [], 0
    for solid in solids:
        mesh = solid.to_mesh()
        vertices.append(np.asarray(mesh.vert_properties[:, :3], float))
        triangles.append(np.asarray(mesh.tri_verts, np.int64) + count)
        count += len(vertices[-1])
    return np.vstack(vertices), np.vstack(triangles)


PIPE = Manifold.cylinder(8.0, 6.0, circular_segments=40) - Manifold.cylinder(8.0, 4.0, circular_segments=40)
RING = Manifold.revolve(CrossSection.circle(2.0, 32).translate((6.0, 0.0)), 48).translate((0.0, 0.0, 2.0))
CAVE = Manifold.cube((9.0, 9.0, 9.0)) - Manifold.cube((4.0, 4.0, 4.0)).translate((2.0, 2.0, 2.0))
SHAPES = {"pipe": (PIPE,), "ring": (RING,), "cavity": (CAVE,), "overlap": (PIPE, RING, CAVE)}


@pytest.mark.parametrize("solids", SHAPES.values(), ids=SHAPES)
def test_areas_are_those_of_manifold3d_and_add_up_to_the_volume(solids):
    union = Manifold.batch_boolean(list(solids), 0) if len(solids) > 1 else solids[0]
    body, layers = LayeredBody(*arrays_of(*solids)), 180
    areas = np.zeros(layers)
    for block in body.blocks(0.05, layers, rows=3000):
        np.add.at(areas, block.layer, block.area)
    for layer in (3, 41, 79, 120, 178):
        assert areas[layer] == pytest.approx(union.slice((layer + 0.5) * 0.05).area(), abs=1e-3)
    assert areas.sum() * 0.05 == pytest.approx(union.volume(), rel=1e-3)


def test_contours_have_their_inside_to_the_left_and_the_same_region_as_manifold3d():
    cut = LayeredBody(*arrays_of(PIPE, CAVE)).cut(np.array([1.0, 4.0]))
    for layer, height in enumerate((1.0, 4.0)):
        own = [cut.points_of(each) for each in cut.of_layer(layer)]
        region = CrossSection(own, FillRule.Positive)
        expected = (PIPE + CAVE).slice(height)
        assert (region - expected).area() + (expected - region).area() < 1e-3
        signed = [signed_area(each) for each in own]
        assert signed == pytest.approx(cut.area[cut.layer == layer].tolist(), abs=1e-3)
        assert sum(signed) == pytest.approx(expected.area(), abs=1e-3)


def test_a_thin_wall_becomes_open_lines_whichever_way_its_triangles_face():
    vertices = np.array([[0, 0, 0], [10, 0, 0], [10, 0, 5], [0, 0, 5], [10, 7, 0], [10, 7, 5]], float)
    triangles = np.array([[0, 1, 2], [0, 3, 2], [1, 4, 5], [1, 2, 5]])
    cut = LayeredBody(vertices, triangles, is_surface=True).cut(np.array([1.0, 2.0, 6.0]))
    assert cut.is_open
    assert cut.layer.tolist() == [0, 1]
    for each in (0, 1):
        ends = {tuple(point) for point in cut.points_of(each)[[0, -1]].tolist()}
        assert ends == {(0.0, 0.0), (10.0, 7.0)}
    assert cut.length_of(range(2)) == pytest.approx(2 * 17.0)


def test_a_closed_wall_ends_where_it_begins():
    around = [[1, 0], [0, 1], [-1, 0], [0, -1]]
    vertices = np.array([[x, y, z] for z in (0, 3) for x, y in around], float)
    triangles = np.array(
        [q for i in range(4) for q in ([i, (i + 1) % 4, 4 + i], [4 + i, (i + 1) % 4, 4 + (i + 1) % 4])]
    )
    cut = LayeredBody(vertices, triangles, is_surface=True).cut(np.array([1.0]))
    assert len(cut.layer) == 1
    assert cut.points_of(0)[0] == pytest.approx(cut.points_of(0)[-1])
    assert cut.length_of(range(1)) == pytest.approx(4 * np.sqrt(2.0))


def test_numbers_are_written_as_python_writes_them():
    rng = np.random.default_rng(4)
    rows = np.append(rng.integers(-(10**9), 10**9, 500), [0, 1, -1, 9999, -10000, 10**12]).reshape(-1, 2)
    expected = "".join(f"<{x / 1e4:.4f} {y / 1e4:.4f}>" for x, y in rows.tolist())
    assert rows_text(rows, 4, (b"<", b" ", b">")).decode() == expected
    heads, first = np.array([[7], [8]]), np.array([0, 1, 3])
    text = groups_text(heads, (b"#", b":", b"\n"), rows[:3], first, (b"", b",", b";"), 0).decode()
    a, b, c = (f"{x},{y};" for x, y in rows[:3].tolist())
    assert text == f"#7:{a}\n#8:{b}{c}\n"
