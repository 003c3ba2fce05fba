"""Repair keeps the shape of meshes, reports every change, and accepts the solids that manifold3d accepts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold, Mesh64
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.checks.meshes import check_part
from amprep.errors import MeshError
from amprep.geometry.meshes import repair as solids_module
from amprep.geometry.meshes import shells as shells_module
from amprep.geometry.meshes.repair import repair_mesh
from amprep.model import Appearance, Mesh, Part, Region
from amprep.pipeline.reading import repair_part


def arrays(solid):
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts).astype(np.int64)


CUBE = arrays(Manifold.cube((1, 1, 1)))
BALL = arrays(Manifold.sphere(1.0, 24))
BALL_VOLUME = Manifold.sphere(1.0, 24).volume()


def together(*meshes):
    first = np.cumsum([0, *(len(v) for v, _ in meshes)])
    return np.vstack([v for v, _ in meshes]), np.vstack(
        [t + n for (_, t), n in zip(meshes, first, strict=False)]
    )


def scaled(mesh, factor=1.0, shift=(0, 0, 0)):
    return mesh[0] * factor + shift, mesh[1]


def inverted(mesh):
    return mesh[0], mesh[1][:, ::-1]


def part_of(mesh, **more):
    return Part("thing", Mesh(mesh[0], mesh[1].astype(np.int32)), 0.0, **more)


def test_a_good_mesh_stays_bit_for_bit_as_it_is():
    repaired = repair_mesh(*BALL)
    assert repaired.vertices.tobytes() == BALL[0].tobytes()
    assert np.array_equal(repaired.triangles, BALL[1])
    assert (repaired.notes, repaired.problem) == ((), "")
    assert repaired.volume == pytest.approx(BALL_VOLUME, rel=1e-12)


def test_equal_vertices_are_merged_and_reported():
    soup = CUBE[0][CUBE[1]].reshape(-1, 3)
    repaired = repair_mesh(soup, np.arange(36).reshape(-1, 3))
    assert len(repaired.vertices) == 8
    assert repaired.volume == pytest.approx(1.0)
    assert repaired.notes == ("merged 28 vertices with others at the same place",)


def test_degenerate_and_repeated_triangles_are_dropped_and_reported():
    extra = np.vstack([CUBE[1], [[0, 0, 1]], np.roll(CUBE[1][:1], 1, axis=1)])
    repaired = repair_mesh(CUBE[0], extra)
    assert repaired.notes == ("dropped 1 degenerate triangle", "dropped 1 repeated triangle")
    assert np.array_equal(repaired.triangles, CUBE[1])
    assert repaired.kept.tolist() == list(range(12))


def test_vertices_no_triangle_uses_do_not_stretch_the_box():
    repaired = repair_mesh(np.vstack([CUBE[0], [[99, 99, 99]]]), CUBE[1])
    assert repaired.vertices.max() == 1.0


def test_an_inside_out_mesh_is_turned_and_reported():
    repaired = repair_mesh(*inverted(BALL))
    assert repaired.notes == ("the mesh was inside out: reversed",)
    assert repaired.volume == pytest.approx(BALL_VOLUME)
    assert repaired.turned.all()
    assert np.array_equal(repaired.triangles, BALL[1])


def test_one_shell_inside_out_is_turned_and_the_others_stay():
    repaired = repair_mesh(*together(BALL, scaled(inverted(BALL), 0.5, (5, 0, 0))))
    assert repaired.notes == ("1 of 2 shells was inside out: reversed",)
    assert repaired.volume == pytest.approx(BALL_VOLUME * (1 + 0.125))


def test_the_cavity_of_a_hollow_ball_stays_a_cavity():
    repaired = repair_mesh(*together(BALL, scaled(inverted(BALL), 0.5)))
    assert repaired.notes == ()
    assert repaired.volume == pytest.approx(BALL_VOLUME * (1 - 0.125))


def test_a_hollow_ball_inside_out_is_turned_with_its_cavity():
    repaired = repair_mesh(*together(inverted(BALL), scaled(BALL, 0.5)))
    assert repaired.notes == ("the mesh was inside out: reversed",)
    assert repaired.volume == pytest.approx(BALL_VOLUME * (1 - 0.125))


def test_overlapping_shells_count_once():
    repaired = repair_mesh(*together(CUBE, scaled(CUBE, 1.0, (0.5, 0, 0))))
    assert repaired.notes == ()
    assert len(repaired.triangles) == 24
    assert repaired.volume == pytest.approx(1.5)


def test_a_cavity_where_two_shells_overlap_is_still_inside_one_of_them():
    cavity = scaled(inverted(CUBE), 0.2, (0.6, 0.4, 0.4))
    repaired = repair_mesh(*together(CUBE, scaled(CUBE, 1.0, (0.5, 0, 0)), cavity))
    assert repaired.volume == pytest.approx(1.5)


def test_a_cavity_where_only_one_shell_is_is_hollow():
    cavity = scaled(inverted(CUBE), 0.2, (0.1, 0.4, 0.4))
    repaired = repair_mesh(*together(CUBE, scaled(CUBE, 1.0, (0.5, 0, 0)), cavity))
    assert repaired.volume == pytest.approx(1.5 - 0.008)


@examples(30)
@given(
    st.lists(st.tuples(*[st.integers(0, 6)] * 3, st.integers(1, 4), st.booleans()), min_size=1, max_size=6)
)
def test_the_volume_is_that_of_positive_winding_number_counted_cell_by_cell(boxes):
    """Boxes with whole corners inside a great one: count the unit cells whose winding number is positive."""
    cells = np.zeros((12, 12, 12), int)
    cells[:] = 1
    meshes = [scaled(CUBE, 12.0)]
    for x, y, z, size, hollow in boxes:
        cells[x + 1 : x + 1 + size, y + 1 : y + 1 + size, z + 1 : z + 1 + size] += -1 if hollow else 1
        box = scaled(CUBE, size, (x + 1, y + 1, z + 1))
        meshes.append(inverted(box) if hollow else box)
    repaired = repair_mesh(*together(*meshes))
    if not repaired.notes:  # boxes that coincide are merged, and reported
        assert repaired.volume == pytest.approx((cells > 0).sum())


@pytest.mark.parametrize("shift", [(1, 0, 0), (1, 1, 0), (1, 1, 1)], ids=["face", "edge", "corner"])
def test_solids_that_touch_are_accepted_whatever_an_edge_count_says(shift):
    repaired = repair_mesh(*together(CUBE, scaled(CUBE, 1.0, shift)))
    assert repaired.problem == ""
    assert repaired.volume == pytest.approx(2.0)


def test_many_shells_are_measured_in_short_time_and_overlaps_still_count_once():
    corners = np.random.default_rng(2).integers(0, 60, (3000, 3)).astype(float)
    cells = np.zeros((61, 61, 61), bool)
    cells[tuple(corners.astype(int).T)] = True
    repaired = repair_mesh(*together(*(scaled(CUBE, 1.0, corner) for corner in corners)))
    assert repaired.volume == pytest.approx(cells.sum())


def test_too_many_overlapping_shells_are_reported(monkeypatch):
    for module in (shells_module, solids_module):
        monkeypatch.setattr(module, "MAX_UNITED", 1)
    repaired = repair_mesh(*together(CUBE, scaled(CUBE, 1.0, (0.5, 0, 0))))
    assert repaired.volume == pytest.approx(2.0)
    assert "counts overlaps repeatedly" in repaired.notes[0]


def test_a_seam_narrower_than_the_tolerance_is_closed_and_reported():
    soup = CUBE[0][CUBE[1]].reshape(-1, 3)
    torn = soup + np.random.default_rng(1).uniform(-1e-5, 1e-5, soup.shape)
    repaired = repair_mesh(torn, np.arange(36).reshape(-1, 3))
    assert repaired.problem == ""
    assert repaired.volume == pytest.approx(1.0, abs=1e-3)
    assert repaired.notes == ("joined 28 vertices along open seams up to 0.0001 mm wide",)


def test_a_gap_wider_than_the_tolerance_is_not_closed():
    soup = CUBE[0][CUBE[1]].reshape(-1, 3)
    torn = soup + np.random.default_rng(1).uniform(-0.01, 0.01, soup.shape)
    assert "odd number of triangles" in repair_mesh(torn, np.arange(36).reshape(-1, 3)).problem


@pytest.mark.parametrize(
    ("vertices", "triangles", "words"),
    [
        (CUBE[0], CUBE[1][1:], "3 edges border an odd number of triangles"),
        (CUBE[0], np.vstack([CUBE[1][:1, ::-1], CUBE[1][1:]]), "triangles that face opposite ways"),
        (CUBE[0], CUBE[1][:0], "no triangles"),
        (CUBE[0], np.array([[0, 0, 1]]), "zero area"),
        (CUBE[0] * [1, 1, np.nan], CUBE[1], "NaN"),
        (CUBE[0] + [0, 0, np.inf], CUBE[1], "infinite"),
        (CUBE[0], CUBE[1] + 1, "a vertex that does not exist"),
        (CUBE[0], CUBE[1] - 1, "a vertex that does not exist"),
        (CUBE[0] * 1e200, CUBE[1], "too large"),
        (CUBE[0][:3], np.array([[0, 1, 2], [2, 1, 0]]), "volume is zero"),
        (CUBE[0] * [1, 1, 0], CUBE[1], "volume is zero"),
    ],
)
def test_a_mesh_that_is_not_a_solid_gets_a_reason(vertices, triangles, words):
    repaired = repair_mesh(vertices, triangles)
    assert words in repaired.problem
    assert "\n" not in repaired.problem
    assert repaired.volume == 0.0


def test_the_place_of_a_hole_is_named():
    assert "first near (" in repair_mesh(CUBE[0], CUBE[1][1:]).problem


@examples(200)
@given(
    st.lists(st.permutations(range(6)), min_size=1, max_size=4),
    st.lists(st.lists(st.integers(0, 5), min_size=3, max_size=3), max_size=1),
    st.integers(0, 1000),
)
def test_a_mesh_that_manifold3d_accepts_is_never_rejected(tetrahedra, more, seed):
    """Tetrahedra over six points that often coincide; the oracle is manifold3d on the arrays as they come."""
    vertices = np.random.default_rng(seed).integers(0, 3, (6, 3)).astype(float)
    faces = [[p[0], p[2], p[1]] for p in tetrahedra] + [[p[0], p[1], p[3]] for p in tetrahedra]
    faces += [[p[1], p[2], p[3]] for p in tetrahedra] + [[p[0], p[3], p[2]] for p in tetrahedra] + more
    repaired = repair_mesh(vertices, faces)
    if not more:  # then all edges match; where they do not, manifold3d itself may crash
        judged = Manifold(Mesh64(vertices, np.array(faces, np.uint64)))
        if judged.status().name == "NoError" and judged.volume() > 1e-9:
            assert repaired.problem == ""
    if not repaired.problem:
        assert repaired.volume > 0.0
        again = Manifold(Mesh64(np.array(repaired.vertices), repaired.triangles.astype(np.uint64)))
        assert again.status().name == "NoError"


def test_a_repaired_part_keeps_the_promise_and_the_judge_finds_one_that_is_not():
    part = part_of(inverted(BALL))
    assert {violation.promise for violation in check_part(part)} == {"orientation", "volume"}
    assert check_part(repair_part(part, allow_surface=False)) == []


def test_a_part_that_is_not_a_solid_is_refused_by_name_and_reason():
    with pytest.raises(MeshError, match=r"thing is not a solid: 3 edges .*--allow-surface"):
        repair_part(part_of((CUBE[0], CUBE[1][1:])), allow_surface=False)


def test_a_surface_is_taken_as_it_is_if_allowed():
    part = repair_part(part_of((CUBE[0], CUBE[1][1:])), allow_surface=True)
    assert not part.is_solid
    assert len(part.mesh.triangles) == 11
    assert "taken as a surface" in part.notes[-1]
    assert check_part(part) == []


def test_nan_is_refused_even_as_a_surface():
    with pytest.raises(MeshError, match="NaN"):
        repair_part(part_of((CUBE[0] * [1, 1, np.nan], CUBE[1])), allow_surface=True)


def test_colours_and_regions_follow_their_triangles():
    mesh = CUBE[0], np.vstack([[[0, 0, 1]], CUBE[1][:, ::-1]])
    colours = np.arange(39).reshape(13, 3)
    part = part_of(
        mesh,
        appearance=Appearance(triangle_colours=colours),
        regions=(Region("blocker", "r", np.array([0, 12])),),
    )
    repaired = repair_part(part, allow_surface=False)
    assert present(repaired.appearance.triangle_colours)[0].tolist() == [5, 4, 3]
    assert present(repaired.regions[0].triangles).tolist() == [11]
    assert check_part(repaired) == []
