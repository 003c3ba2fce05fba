"""Cells on small layouts have volumes known by hand; the judge of finished supports finds each broken promise."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of

from amprep.cells.instances import classify, expand_cells
from amprep.checks.supports.bodies import CLOSED, INSIDE, PENETRATION, STANDING, check_bodies
from amprep.geometry.meshes.manifold import as_manifold
from amprep.host import Host
from amprep.model import (
    Build,
    BuildSettings,
    BuildVolume,
    CellRequest,
    Grid,
    Mesh,
    Part,
    PlacedPart,
    Stop,
    SupportBody,
    SupportEdges,
    silent,
)
from amprep.supports.solids.keep_out import PartObstacles, drop_floating, drop_idle


def request_of(edges: list[tuple[int, int, int, int]], pitch: float = 2.0) -> CellRequest:
    """Edges (plane, y, x, direction) on a grid of 9 x 9 squares; pitch and step are equal."""
    plane, y, x, direction = np.array(edges).T
    grid = Grid(np.zeros(3), pitch, pitch, (12, 9, 9))
    one = np.ones(len(edges))
    return CellRequest(grid, SupportEdges(plane, y, x, direction, one, one, group=0 * one), 0 * one)


def solid_of(cell: str, request: CellRequest, **params):
    """The union of a cell's instances, as the host makes it."""
    from manifold3d import Manifold, OpType

    host = Host.load(plugins_enabled=False)
    listed = host.choose("cell", cell)
    cells = host.call(listed, request, params=host.params(listed, params), stop=Stop(), progress=silent)
    instances = classify(request, cells)
    meshes = expand_cells(instances, np.ones(len(cells.edge), np.bool_))
    return Manifold.batch_boolean([as_manifold(*mesh) for mesh in meshes], OpType.Add)


def column(height: int, y: int = 4, x: int = 4) -> list[tuple[int, int, int, int]]:
    return [(plane, y, x, 0) for plane in range(1, height + 1)]


def test_a_column_of_prisms_is_a_box():
    solid = solid_of("prism", request_of(column(5)))
    assert solid.volume() == pytest.approx(5 * 2.0**3)
    assert solid.num_tri() >= 12


def test_a_straight_and_an_oblique_prism_with_a_common_square_overlap_by_half():
    solid = solid_of("prism", request_of([(1, 4, 4, 0), (1, 4, 4, 1)]))
    assert solid.volume() == pytest.approx(1.5 * 2.0**3)


@pytest.mark.parametrize("cell", ["prism", "x-wall"])
def test_united_cells_have_the_volume_of_the_batch_union(cell):
    """Against manifold3d's union of all instances, one by one."""
    from manifold3d import Manifold, OpType

    rng = np.random.default_rng(3)
    edges = sorted(
        {(int(p), int(y), int(x), int(d)) for p, y, x, d in rng.integers([1, 2, 2, 0], [5, 6, 6, 5], (60, 4))}
    )
    request = request_of(edges)
    host = Host.load(plugins_enabled=False)
    listed = host.choose("cell", cell)
    cells = host.call(listed, request, params=host.params(listed, {}), stop=Stop(), progress=silent)
    single = []
    for template, matrix in zip(cells.template, cells.matrix, strict=True):
        mesh = cells.templates[template].mesh
        points = mesh.vertices @ matrix[:, :3].T + matrix[:, 3]
        single.append(as_manifold(points, mesh.triangles.astype(np.int64)))
    expected = Manifold.batch_boolean(single, OpType.Add).volume()
    assert solid_of(cell, request).volume() == pytest.approx(expected, rel=1e-6)


def test_neighbouring_x_walls_meet_only_in_every_third_layer():
    """Two columns side by side, cut in the middle of each layer: one piece where they meet, else two."""
    solid = solid_of("x-wall", request_of(column(6, x=3) + column(6, x=4)))
    pieces = [len(solid.slice(2.0 * layer + 1.0).decompose()) for layer in range(6)]
    assert pieces == [2, 2, 1, 2, 2, 1]


def test_the_wall_thickness_gives_the_cross_section_of_the_x():
    """Two strips of width t along the diagonals of a square s, clipped to it: 2 t d - t^2 - t^2, d = s sqrt 2."""
    wall, side = 0.3, 2.0
    area = solid_of("x-wall", request_of(column(3)), wall_mm=wall).slice(5.0).area()
    diagonal = side * np.sqrt(2.0)
    assert area == pytest.approx(2 * wall * diagonal - 2 * wall**2, rel=1e-5)  # files keep float32


# --------------------------------------------------------------------------------------------- the judge


def box(lo, hi) -> Mesh:
    from manifold3d import Manifold

    lo, hi = np.array(lo, float), np.array(hi, float)
    mesh = Manifold.cube((hi - lo).tolist()).translate(lo.tolist()).to_mesh64()
    return Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def build_of(*meshes: Mesh, overlap: float = 0.1, parts: tuple[int, ...] = (0,)) -> Build:
    """A slab from z = 10 to 15 on supports."""
    slab = box((10, 10, 10), (30, 30, 15))
    placed = PlacedPart("slab", Part("slab", slab, slab.signed_volume), np.eye(4))
    settings = BuildSettings("test", BuildVolume(np.array([50.0, 50.0, 50.0])), overlap=overlap)
    bodies = tuple(SupportBody(f"supports {i}", mesh, parts) for i, mesh in enumerate(meshes))
    return Build(settings, (placed,), bodies)


def broken(build: Build) -> set[str]:
    return {violation.promise for violation in check_bodies(build, Stop())}


def test_a_post_that_enters_its_part_by_the_overlap_keeps_every_promise():
    assert broken(build_of(box((15, 15, 0), (17, 17, 10.1)))) == set()


@pytest.mark.parametrize(
    ("mesh", "promise"),
    [
        (box((15, 15, 0), (17, 17, 10.2)), PENETRATION),
        (box((15, 15, 1), (17, 17, 10.1)), STANDING),
        (box((15, 15, -1), (17, 17, 10.1)), INSIDE),
        (box((45, 15, 0), (51, 17, 10.1)), INSIDE),
        (
            Mesh(box((15, 15, 0), (17, 17, 10)).vertices, box((15, 15, 0), (17, 17, 10)).triangles[:-1]),
            CLOSED,
        ),
        (
            Mesh(box((15, 15, 0), (17, 17, 10)).vertices, box((15, 15, 0), (17, 17, 10)).triangles[:, ::-1]),
            CLOSED,
        ),
    ],
)
def test_the_judge_finds_each_broken_promise(mesh, promise):
    assert promise in broken(build_of(mesh))


def test_a_part_that_a_body_does_not_hold_may_not_be_entered_at_all():
    assert PENETRATION in broken(build_of(box((15, 15, 0), (17, 17, 10.05)), parts=()))


def test_contact_along_a_steep_wall_is_no_penetration():
    """The wall is entered horizontally by less than the contact tolerance, over its whole height."""
    assert broken(build_of(box((30 - 0.0009, 15, 0), (32, 17, 15)))) == set()


def test_a_floating_component_and_a_void_are_distinguished():
    outer, void = box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (2, 2, 2))
    hollow = Mesh(
        np.vstack([outer.vertices, void.vertices]),
        np.vstack([outer.triangles, void.triangles[:, ::-1] + len(outer.vertices)]),
    )
    assert STANDING not in broken(build_of(hollow))
    floating = box((6, 0, 1), (7, 1, 2))
    both = Mesh(
        np.vstack([hollow.vertices, floating.vertices]),
        np.vstack([hollow.triangles, floating.triangles + len(hollow.vertices)]),
    )
    assert STANDING in broken(build_of(both))
    points, triangles = drop_floating(both.vertices, both.triangles)
    assert Mesh(points, triangles).signed_volume == pytest.approx(64 - 1)


def test_pieces_that_touch_no_part_are_dropped_with_their_voids():
    part = mesh_of(Manifold.cube((10, 10, 2)).translate((0, 0, 5)))
    post = Manifold.cube((2, 2, 5.1)).translate((1, 1, 0)) - Manifold.cube((1, 1, 1)).translate((1.5, 1.5, 2))
    beside = Manifold.cube((2, 2, 5)).translate((4, 4, 0))  # no vertex of it is inside the part
    idle = Manifold.cube((2, 2, 4)).translate((7, 7, 0)) - Manifold.cube((1, 1, 1)).translate((7.5, 7.5, 1))

    def kept_of(solid):
        whole = mesh_of(solid)
        return Mesh(*drop_idle(whole.vertices, whole.triangles, [part]))

    assert kept_of(Manifold.compose([post, beside, idle])).signed_volume == pytest.approx(4 * 5.1 - 1 + 20)
    assert not len(kept_of(idle).triangles)
    for each in (post, beside):
        assert len(kept_of(each).triangles) == len(mesh_of(each).triangles)


@pytest.mark.parametrize("inwards", [True, False])
def test_crumbs_that_rounding_leaves_are_dropped_whether_they_look_like_voids_or_not(inwards):
    outer, crumb = box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (1.04, 1.04, 1.04))
    corners = crumb.triangles[:, ::-1] if inwards else crumb.triangles
    points = np.vstack([outer.vertices, crumb.vertices])
    points, triangles = drop_floating(points, np.vstack([outer.triangles, corners + len(outer.vertices)]))
    assert len(points) == len(outer.vertices)
    assert Mesh(points, triangles).signed_volume == pytest.approx(64.0)


@pytest.mark.parametrize(("width", "volume"), [(0.15, 64.0), (0.5, 64.0 - 4.5)])
def test_voids_too_narrow_for_loose_powder_are_filled(width, volume):
    hollow = Manifold.cube((4, 4, 4)) - Manifold.cube((3, 3, width)).translate((0.5, 0.5, 1))
    assert Mesh(*drop_floating(*mesh_of(hollow).arrays)).signed_volume == pytest.approx(volume)


def test_subtracting_parts_leaves_the_overlap_in_held_parts_and_nothing_in_others():
    mesh = box((15, 15, 0), (17, 17, 12))
    post = as_manifold(mesh.vertices, mesh.triangles.astype(np.int64))
    build = build_of()
    held = PartObstacles(build.parts).subtract_from(post, (0,), 0.1)
    free = PartObstacles(build.parts).subtract_from(post, (), 0.1)
    assert held.volume() == pytest.approx(4 * 10.1, abs=4e-3)
    assert free.volume() == pytest.approx(4 * 10.0, abs=4e-3)
    surface = replace(build.parts[0], part=replace(build.parts[0].part, is_solid=False))
    assert PartObstacles((surface,)).subtract_from(post, (0,), 0.1).volume() == pytest.approx(4 * 12)
