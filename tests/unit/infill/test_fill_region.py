"""Filled regions have volumes known by hand; the part around them is unchanged, and trapped powder is found."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.builds import box_mesh
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.cells import cell_offer
from amprep.checks.infill import CELLS, CLOSED, OUTSIDE, WHOLE, check_filled
from amprep.errors import JobError, MeshError
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.offset import offset_inwards
from amprep.host import Host
from amprep.infill.fill_region import fill_region
from amprep.measures.filled_part import pockets_of
from amprep.model import Mesh, MeshCell, Part, Region, Stop, silent
from amprep.model.rotations import parse_rotations
from amprep.pipeline.resolve import cell_named
from amprep.threemf import read_parts, write_parts
from amprep.threemf.names import CURA_NAMESPACE
from amprep.threemf.read.separate_regions import SeparateRegion, assign_regions
from amprep.threemf.read.slicer_config import cura_role
from amprep.threemf.write import write_document
from amprep.threemf.write.document import BuildItem, Document, MeshObject, PlacedObject

ROOT = Path(__file__).parents[3]
PACKAGES = ("gyroid", "honeycomb", "pillar")
HOST = Host.load(
    modules=[
        str(ROOT / "plugins" / f"amprep-{name}" / "src" / f"amprep_{name}" / "__init__.py")
        for name in PACKAGES
    ],
    env={"AMPREP_LOAD_PLUGINS": ""},
)
BLOCK = box_mesh((0, 0, 0), (12, 12, 12))
CORE = box_mesh((2, 2, 2), (8, 8, 8))


def offered(name, **params):
    listed = HOST.choose("cell", name)
    return lambda request: HOST.call(
        listed, request, params=HOST.params(listed, params), stop=Stop(), progress=silent
    )


def drawn(corner, size):
    """A cell that is one box in the unit cube."""
    offer = cell_offer("drawn", "A box.", MeshCell(box_mesh(corner, size)))
    return lambda request: offer.run(request, params=offer.params(), stop=Stop(), progress=silent)


POST = drawn((0.25, 0.25, 0.0), (0.5, 0.5, 1.0))
FLOATING = drawn((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))


def judged(part, regions, filled):
    return check_filled("part", part, regions, filled.cells, filled.mesh, dropped=filled.dropped_volume_mm3)


def test_the_packages_in_plugins_are_on_offer():
    assert {*PACKAGES} <= {*HOST.offers("cell")}


@pytest.mark.parametrize("name", sorted(HOST.offers("cell")))
def test_every_cell_on_offer_fills_a_core_and_keeps_the_promises(name):
    region = box_mesh((2.5, 2.5, 2.5), (7, 7, 7))
    filled = fill_region(BLOCK, [region], offered(name), size=4.0)
    assert judged(BLOCK, [region], filled) == []
    assert (filled.count, filled.dropped_components) == (8, 0)
    assert 0.02 < filled.density <= 1.0
    assert filled.mesh.signed_volume == pytest.approx(12**3 - 7**3 * (1.0 - filled.density), rel=1e-6)


def test_cells_of_files_fill_a_core(tmp_path):
    from amprep.stl import write_stl

    write_stl(box_mesh((0.25, 0.25, 0.0), (0.5, 0.5, 1.0)), tmp_path / "post.stl")
    (tmp_path / "pin.toml").write_text(
        "points = [[0.5, 0.5, 0], [0.5, 0.5, 1]]\nstruts = [[0, 1]]\nradius_mm = 0.5\n", encoding="utf-8"
    )
    volumes = {}
    for file in ("post.stl", "pin.toml"):
        filled = fill_region(BLOCK, [CORE], cell_named(HOST, str(tmp_path / file)).emit, size=4.0)
        assert judged(BLOCK, [CORE], filled) == []
        volumes[file] = filled.cells_mm3
    assert volumes["post.stl"] == pytest.approx(4 * 2 * 2 * 8)
    assert volumes["pin.toml"] == pytest.approx(4 * np.pi / 4 * 8, rel=0.1)


def test_a_region_of_whole_cells_is_filled_with_whole_cells_that_extend_beyond_it():
    filled = fill_region(BLOCK, [CORE], POST, size=4.0)
    assert filled.count == 4**3, "2 x 2 x 2 of them in the region, and those that its faces touch"
    assert filled.cells_mm3 == pytest.approx(4 * 2 * 2 * 8)
    assert filled.density == pytest.approx(0.25)
    assert filled.genus == 4, "each post is a handle of the cavity"
    assert judged(BLOCK, [CORE], filled) == []


@given(st.floats(1.0, 3.0), st.floats(3.0, 5.0), st.floats(3.0, 5.0), st.integers(0, 3))
@examples(5)
def test_promises_hold_for_every_position_of_region_and_grid(corner, size, height, turns):
    region = Mesh(
        *arrays_of(Manifold.cube([7.3, 6.1, 13.0]).rotate([11 * turns, 7, 0]).translate([corner] * 3))
    )
    filled = fill_region(BLOCK, [region], offered("bcc", diameter_mm=0.9), size=size, height=height)
    assert judged(BLOCK, [region], filled) == []


def test_prisms_leave_the_part_as_it_was():
    filled = fill_region(BLOCK, [CORE], offered("prism"), size=3.0)
    assert filled.mesh.signed_volume == pytest.approx(12**3)
    assert filled.density == pytest.approx(1.0)


def test_regions_are_united_and_their_volume_outside_the_part_stays_empty():
    regions = [box_mesh((-3, 2, 2), (9, 8, 8)), box_mesh((4, 2, 2), (12, 8, 8))]
    filled = fill_region(BLOCK, regions, POST, size=4.0)
    assert filled.region.signed_volume == pytest.approx(12 * 8 * 8)
    assert filled.mesh.bounds[0] == pytest.approx([0, 0, 0])
    assert judged(BLOCK, regions, filled) == []


def test_disconnected_components_are_dropped_and_counted():
    filled = fill_region(BLOCK, [CORE], FLOATING, size=4.0)
    assert filled.dropped_components == 8
    assert filled.dropped_volume_mm3 == pytest.approx(8 * 2**3)
    assert filled.mesh.signed_volume == pytest.approx(12**3 - 8**3)
    assert judged(BLOCK, [CORE], filled) == []


def test_of_a_part_completely_inside_the_region_the_largest_component_remains():
    region = box_mesh((-1, -1, -1), (14, 14, 14))
    filled = fill_region(BLOCK, [region], offered("bcc", diameter_mm=1.0), size=4.0)
    assert filled.mesh.signed_volume > 100
    assert judged(BLOCK, [region], filled) == []


def test_cells_that_do_not_hold_a_part_together_are_found():
    cut = box_mesh((-1, -1, 4), (14, 14, 4))
    filled = fill_region(BLOCK, [cut], FLOATING, size=4.0)
    assert [found.promise for found in judged(BLOCK, [cut], filled)] == [WHOLE]


def test_the_judge_finds_each_broken_promise():
    filled = fill_region(BLOCK, [CORE], POST, size=4.0)

    def broken(after):
        return {found.promise for found in check_filled("part", BLOCK, [CORE], filled.cells, after)}

    assert broken(filled.mesh) == set()
    assert broken(Mesh(filled.mesh.vertices, filled.mesh.triangles[1:])) == {CLOSED}
    assert broken(
        filled.mesh.moved(np.array([[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]))
    ) == {OUTSIDE}
    assert broken(BLOCK) == {CELLS}


def test_regions_that_cannot_be_filled_are_refused():
    with pytest.raises(JobError, match="outside the part"):
        fill_region(BLOCK, [box_mesh((20, 0, 0), (5, 5, 5))], POST, size=4.0)
    with pytest.raises(JobError, match="at most 50000000 voxels"):
        fill_region(BLOCK, [CORE], POST, size=0.02, overlap=0.001)
    with pytest.raises(JobError, match=r"twice cells\.overlap_mm"):
        fill_region(BLOCK, [CORE], POST, size=0.4, overlap=0.3)
    with pytest.raises(MeshError, match="a region is not a solid"):
        fill_region(BLOCK, [Mesh(CORE.vertices, CORE.triangles[1:])], POST, size=4.0)
    with pytest.raises(JobError, match="struts only"):
        fill_region(BLOCK, [CORE], POST, size=4.0, beams=True)


def test_a_closed_core_traps_powder_and_an_open_one_does_not():
    closed = fill_region(BLOCK, [CORE], POST, size=4.0)
    (pocket,) = pockets_of(closed.mesh, 0.3)
    assert pocket.closed
    assert pocket.volume == pytest.approx(8**3 - closed.cells_mm3, rel=0.03)
    assert min(pocket.lo) > 2 - 0.3
    below = fill_region(BLOCK, [box_mesh((2, 2, -1), (8, 8, 9))], POST, size=4.0)
    assert pockets_of(below.mesh, 0.3) == (), "once off the plate, powder leaves below"


def test_beams_are_those_struts_as_solids():
    region = box_mesh((2.5, 2.5, 2.5), (7, 7, 7))
    filled = fill_region(BLOCK, [region], offered("bcc", diameter_mm=0.8), size=7.5, beams=True)
    lattice = present(filled.lattice)
    struts = lattice.nodes[lattice.struts]
    solids = [as_manifold(lattice.solids.vertices, lattice.solids.triangles)]
    for (start, end), (radius, _) in zip(struts, lattice.radii, strict=True):
        ball = Manifold.sphere(radius, 16)
        solids.append(Manifold.batch_hull([ball.translate(start), ball.translate(end)]))
    from manifold3d import OpType

    whole = Manifold.batch_boolean(solids, OpType.Add) ^ as_manifold(BLOCK.vertices, BLOCK.triangles)
    assert whole.volume() == pytest.approx(filled.mesh.signed_volume, rel=5e-3)


def test_the_inside_of_a_box_is_a_smaller_box_nowhere_nearer_than_the_shell():
    points, triangles = offset_inwards(np.array(BLOCK.vertices), BLOCK.triangles.astype(np.int64), 1.5, 0.75)
    depth = np.minimum(points.min(axis=1), (12 - points).min(axis=1))
    assert depth.min() > 1.5 - 1e-6
    assert as_manifold(points, triangles).volume() == pytest.approx(9**3, rel=0.03)


def test_a_part_thinner_than_two_shells_has_no_inside():
    _, triangles = offset_inwards(np.array(BLOCK.vertices), BLOCK.triangles.astype(np.int64), 6.5, 2.0)
    assert len(triangles) == 0


def test_parts_written_come_back_as_they_were(tmp_path):
    regions = (Region("blocker", "no", mesh=CORE), Region("enforcer", "yes", mesh=CORE))
    turned = parse_rotations("z90")
    part = Part(
        "block & co", BLOCK, 1728.0, 6, 2.5, turned, regions, positions=np.array([[5.0, 6, 7], [30, 6, 7]])
    )
    write_parts([part], tmp_path / "a.3mf", title="a", target="prusaslicer")
    (back,) = read_parts(tmp_path / "a.3mf")
    assert (back.name, back.quantity, back.value) == ("block & co", 6, 2.5)
    assert np.array_equal(back.orientations.matrices, turned.matrices)
    assert np.array_equal(back.positions, part.positions)
    assert [(region.kind, region.name) for region in back.regions] == [("blocker", "no"), ("enforcer", "yes")]
    assert back.mesh.signed_volume == pytest.approx(12**3)
    write_parts([part], tmp_path / "b.3mf", title="b")
    (back,) = read_parts(tmp_path / "b.3mf")
    assert back.regions == ()
    assert back.mesh.signed_volume == pytest.approx(12**3), (
        "without PrusaSlicer's list nothing tells volumes apart"
    )


def test_modifiers_of_cura_mark_the_parts_that_contain_them():
    role = present(cura_role({(CURA_NAMESPACE, "infill_mesh"): "True"}, "core"))
    assert (role.kind, role.name) == ("modifier", "core")
    assert cura_role({(CURA_NAMESPACE, "infill_mesh"): "False"}, "core") is None
    parts = [
        Part(name, BLOCK, 1728.0, positions=np.array([[at, 0.0, 0.0]]))
        for name, at in (("a", 50.0), ("b", 90.0))
    ]
    a, b = assign_regions(
        parts, [SeparateRegion(Region("lattice", "core", mesh=CORE), np.array([[50.0, 1.0, 0.0]]))]
    )
    assert b.regions == ()
    assert present(a.regions[0].mesh).bounds[0] == pytest.approx([2, 3, 2])


def test_a_plate_of_cura_is_read_with_its_modifier_as_a_region_not_as_a_part(tmp_path):
    bodies = (
        MeshObject("block", BLOCK),
        MeshObject("core", CORE, metadata=((CURA_NAMESPACE, "infill_mesh", "True"),)),
    )
    place = np.eye(4)
    place[:3, 3] = (30, 40, 0)
    items = tuple(BuildItem((PlacedObject(number, place),), ()) for number in (1, 0))
    write_document(Document("plate", (), bodies, items), tmp_path / "plate.3mf", with_volumes=False)
    (part,) = read_parts(tmp_path / "plate.3mf")
    (region,) = part.regions
    assert (part.name, region.kind, region.name) == ("block", "lattice", "core")
    assert present(region.mesh).bounds[0] == pytest.approx([2, 2, 2])
    assert any("'amprep lattice' fills it" in note for note in part.notes)
