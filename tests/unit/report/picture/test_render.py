"""The depth buffer agrees with brute force, and pictures show parts, supports and marks."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from amprep.kernels.picture.rasterise import DepthBuffer, draw
from amprep.model import Build, BuildSettings, BuildVolume, Mesh, Part, PlacedPart, SupportBody, Unsupported
from amprep.report.picture import build_picture, draw_mesh, write_picture
from amprep.report.picture.camera import box_corners, fitted, view_axes
from amprep.report.picture.colours import MARK_COLOURS, PALETTE, is_like_a_mark, part_colours, rgb
from amprep.report.picture.marks import balls
from amprep.report.picture.scene import seen_through
from amprep.report.record import BuildRecord
from amprep.report.triage.findings import Finding, build_findings

SIZE = (320, 240)


def box(corner, size) -> Mesh:
    import manifold3d

    made = manifold3d.Manifold.cube(size).translate(corner).to_mesh()
    return Mesh(made.vert_properties[:, :3], made.tri_verts)


def build_of(*meshes: Mesh, supports=(), unsupported=(), space=None) -> Build:
    parts = tuple(
        PlacedPart(f"part {k}", Part(f"part {k}", mesh, mesh.signed_volume), np.eye(4))
        for k, mesh in enumerate(meshes)
    )
    settings = BuildSettings("test", space or BuildVolume((100, 100, 100)))
    return Build(
        settings, parts, tuple(SupportBody("s", mesh, (0,)) for mesh in supports), tuple(unsupported)
    )


def pixels(build: Build, findings=None) -> np.ndarray:
    found = build_findings(BuildRecord(build)) if findings is None else findings
    return np.asarray(build_picture(build, found, SIZE)).astype(int)


def reddish(picture: np.ndarray) -> int:
    return int(((picture[..., 0] > 170) & (picture[..., 1:].max(axis=2) < 110)).sum())


def nearest_by_brute_force(points, triangles, shape):
    """Test every triangle at every pixel by the signs of three areas."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    depth, ids = np.full(shape, np.inf), np.full(shape, -1)
    edge_near = np.zeros(shape, bool)
    for k, (a, b, c) in enumerate(points[triangles]):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        weights = [
            ((q[0] - p[0]) * (rows - p[1]) - (columns - p[0]) * (q[1] - p[1])) / area
            for p, q in ((b, c), (c, a), (a, b))
        ]
        near = sum(weight * corner[2] for weight, corner in zip(weights, (a, b, c), strict=True))
        inside = np.min(weights, axis=0)
        edge_near |= np.abs(inside) < 1e-6
        won = (inside > 0) & (near < depth)
        depth[won], ids[won] = near[won], k
    return depth, ids, edge_near


@pytest.mark.parametrize("seed", range(5))
def test_the_depth_buffer_agrees_with_brute_force(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform([-10, -10, 0], [50, 40, 9], (60, 3))
    triangles = np.arange(60, dtype=np.int32).reshape(20, 3)
    depth, ids = np.full((30, 40), np.inf, np.float32), np.full((30, 40), -1, np.int32)
    draw(points, triangles, DepthBuffer(depth, ids))
    expected_depth, expected_ids, edge_near = nearest_by_brute_force(points, triangles, (30, 40))
    assert (ids == expected_ids)[~edge_near].all()
    np.testing.assert_allclose(depth[~edge_near], expected_depth[~edge_near], rtol=1e-5, atol=1e-4)


def test_triangles_without_area_or_outside_the_picture_draw_nothing():
    points = np.array([[0, 0, 1], [5, 5, 1], [9, 9, 1], [-9, -9, 1], [-5, -9, 1], [-9, -5, 1]], np.float64)
    depth, ids = np.full((10, 10), np.inf, np.float32), np.full((10, 10), -1, np.int32)
    draw(points, np.array([[0, 1, 2], [3, 4, 5]], np.int32), DepthBuffer(depth, ids))
    assert (ids == -1).all()


def test_a_camera_shows_all_points_it_is_fitted_to_and_its_inverse_restores_them():
    corners = box_corners(np.zeros(3), np.array([30.0, 200.0, 10.0]))
    camera = fitted(view_axes(-62.0, 34.0), corners, (400, 300), margin=20.0)
    seen = camera.project(corners)
    assert seen[:, :2].min() >= 20 - 1e-9
    assert (seen[:, 0].max(), seen[:, 1].max()) <= (380 + 1e-9, 280 + 1e-9)
    back = seen @ camera.inverse[:, :3].T + camera.inverse[:, 3]
    np.testing.assert_allclose(back, corners, atol=1e-9)


def test_up_and_right_appear_as_up_and_right():
    axes = view_axes(-90.0, 20.0)  # stands at -y: x runs to the right, z up
    np.testing.assert_allclose(axes[0], [1, 0, 0], atol=1e-12)
    assert axes[1] @ [0, 0, 1] < 0  # rows grow downwards
    assert axes[2] @ [0, 1, 0] > 0
    np.testing.assert_allclose(np.linalg.det(axes), 1.0)


def test_parts_appear_in_their_colours_and_copies_share_one():
    build = build_of(box((10, 10, 0), (30, 30, 20)), box((60, 10, 0), (30, 30, 20)))
    assert part_colours(build) == list(PALETTE[:2])
    picture = pixels(build)
    blue = (picture[..., 2] > picture[..., 0] + 40).sum()
    green = (picture[..., 1] > picture[..., 2] + 40).sum()
    assert min(blue, green) > 0.02 * SIZE[0] * SIZE[1]


def test_own_colours_are_used_unless_all_parts_have_the_same():
    build = build_of(box((0, 0, 0), (1, 1, 1)), box((2, 2, 0), (1, 1, 1)))

    def coloured(*colours):
        parts = zip(build.parts, colours, strict=True)
        look = build.parts[0].part.appearance
        return replace(
            build,
            parts=tuple(
                replace(p, part=replace(p.part, appearance=replace(look, colour=c))) for p, c in parts
            ),
        )

    assert part_colours(coloured("#0000FFFF", "#00ff0080")) == ["#0000ff", "#00ff00"]
    assert part_colours(coloured("#0000FFFF", "#0000FFFF")) == list(PALETTE[:2])
    assert part_colours(coloured("#0000FFFF", '"><script>')) == ["#0000ff", PALETTE[1]]
    assert part_colours(coloured(PALETTE[1], "none")) == [PALETTE[1], PALETTE[2]], "no colour of another part"
    assert part_colours(coloured("#FF0000FF", "#F58518")) == list(PALETTE[:2])


def test_unsupported_regions_are_red_and_visible_through_parts():
    block = box((30, 30, 0), (40, 40, 30))
    grid = np.array([[x, y, 31.0] for x in range(40, 61, 2) for y in range(40, 61, 2)])
    above = Unsupported(0, "face", "face", "enclosed", 400.0, grid, 1.5)
    inside = replace(above, points=grid - [0, 0, 15])
    plain, hidden, open_ = (
        pixels(build_of(block, unsupported=regions)) for regions in ((), (inside,), (above,))
    )
    assert reddish(plain) == 0
    assert reddish(open_) > 30
    assert (hidden[..., 0] > plain[..., 0] + 15).sum() > 30


def test_what_must_be_fixed_is_red_what_is_worth_a_check_orange_and_the_rest_has_no_mark():
    build = build_of(box((30, 30, 0), (40, 40, 30)))
    grid = np.array([[x, y, 31.0] for x in range(40, 61, 2) for y in range(40, 61, 2)])

    def marked(triage):
        return pixels(
            build, [Finding(triage, 1, "part 0", "ledge", "overhang 1", "", points=grid, radius=1.5)]
        )

    def orange(picture):
        red, green, blue = (picture[60:, :, channel] for channel in range(3))
        return int(((red > 170) & (green > 90) & (green < 0.75 * red) & (blue < 80)).sum())

    assert reddish(marked("must fix")) > 30
    assert orange(marked("must fix")) == 0
    assert orange(marked("worth a check")) > 30
    assert reddish(marked("worth a check")) < 30
    plain = pixels(build)
    for triage in ("supported", "self-supporting"):
        assert (marked(triage) == plain).all()


def test_no_part_has_a_colour_like_a_mark():
    for colour in PALETTE:
        assert not is_like_a_mark(colour)
        for mark in MARK_COLOURS.values():
            assert is_like_a_mark(mark)
            assert np.abs(np.subtract(rgb(colour), rgb(mark))).max() > 0.3, colour


def test_a_support_below_changes_the_picture_and_an_empty_build_shows_the_plate():
    slab, post = box((20, 20, 30), (60, 60, 5)), box((45, 20, 0), (5, 5, 30))
    assert (pixels(build_of(slab)) != pixels(build_of(slab, supports=[post]))).any()
    empty = pixels(build_of())
    assert np.ptp(empty[120, :, 0]) > 5  # the plate against the background


def test_a_support_inside_a_part_is_faintly_visible_through_it():
    block, post = box((20, 20, 0), (60, 60, 40)), box((45, 45, 0), (8, 8, 30))
    plain, through = pixels(build_of(block)), pixels(build_of(block, supports=[post]))
    lighter = (through.sum(axis=2) > plain.sum(axis=2) + 30) & (plain.sum(axis=2) > 0)
    assert 50 < lighter.sum() < 0.1 * SIZE[0] * SIZE[1]


def test_supports_below_lifted_parts_do_not_cover_the_parts():
    block, mat, leg = (
        box((20, 20, 3), (60, 60, 20)),
        box((20, 20, 0), (60, 60, 3)),
        box((45, 45, 0), (8, 8, 20)),
    )
    build = build_of(block, supports=[mat])
    lifted = replace(build, settings=replace(build.settings, lift=3.0))
    assert len(seen_through(lifted, np.array([0.0, 1.0, 0.0]))[0].mesh.triangles) == 0
    tall = replace(lifted, supports=build_of(block, supports=[leg]).supports)
    assert len(seen_through(tall, np.array([0.0, 1.0, 0.0]))[0].mesh.triangles) > 4


def test_a_mark_is_before_a_support_that_is_seen_through_a_part():
    block, post = box((20, 20, 0), (60, 60, 40)), box((45, 45, 0), (8, 8, 30))
    region = Unsupported(0, "face", "face", "enclosed", 4.0, [[49.0, 49.0, 41.0]], 3.0)
    open_, behind = (build_of(block, supports=supports, unsupported=(region,)) for supports in ((), (post,)))
    assert reddish(pixels(open_)) == reddish(pixels(behind)) > 10


def test_a_round_plate_has_no_corners():
    square = pixels(build_of(space=BuildVolume((100, 100, 50))))
    disc = pixels(build_of(space=BuildVolume((100, 100, 50), "cylinder")))
    assert ((square != disc).any(axis=2)).sum() > 0.02 * SIZE[0] * SIZE[1]


def test_files_are_pictures_of_the_requested_size_with_the_same_bytes_each_time(tmp_path):
    build = build_of(box((10, 10, 0), (30, 30, 20)))
    for name in ("a.png", "b.png"):
        write_picture(build, tmp_path / name, size=SIZE)
    draw_mesh(build.parts[0].mesh, tmp_path / "mesh.png", size=(200, 150))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    for name, size in (("a.png", SIZE), ("mesh.png", (200, 150))):
        with Image.open(tmp_path / name) as picture:
            assert (picture.format, picture.size) == ("PNG", size)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.png", "mesh.png"]


def test_marks_are_spheres_around_their_points():
    mesh = balls(np.array([[0.0, 0, 0], [10, 0, 0]]), np.array([1.0, 2.0]))
    half = len(mesh.vertices) // 2
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices[:half], axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices[half:] - [10, 0, 0], axis=1), 2.0)
    assert mesh.signed_volume > 0  # faces look outwards
