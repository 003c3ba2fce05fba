"""Each build item of a 3MF job becomes a part with its metadata, in millimetres."""

import shutil
import subprocess
import zipfile

import numpy as np
import pytest
import trimesh
from tests.shared.optional import present

from amprep.checks.meshes import check_part
from amprep.errors import InputError
from amprep.pipeline.reading import repair_part
from amprep.threemf import read_parts

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
SPACES = (
    f'xmlns="{CORE}" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" '
    'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" '
    'xmlns:a="http://schemas.amprep.dev/3mf/2026/11" xmlns:v="http://example.org/vendor"'
)
TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
MODEL_TYPE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"


def relations(*more, target="/3D/3dmodel.model"):
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
        f'<Relationship Target="{target}" Id="r1" Type="{MODEL_TYPE}"/>{"".join(more)}</Relationships>'
    )


def pack(path, resources, build, *, unit="millimeter", files=None, rels=None):
    """Write a 3MF package without a library."""
    model = (
        f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xml:lang="en-US" {SPACES}>'
        f"<resources>{resources}</resources><build>{build}</build></model>"
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", TYPES)
        archive.writestr("_rels/.rels", relations() if rels is None else rels)
        archive.writestr("3D/3dmodel.model", model)
        for name, content in (files or {}).items():
            archive.writestr(name, content)
    return path


BOX = trimesh.creation.box((1, 2, 3))


def mesh_xml(mesh=BOX, colour=""):
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in mesh.vertices.tolist())
    corners = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"{colour}/>' for a, b, c in np.asarray(mesh.faces).tolist()
    )
    return f"<mesh><vertices>{points}</vertices><triangles>{corners}</triangles></mesh>"


def box_object(number=1, more="", inside=""):
    return f'<object id="{number}" type="model" {more}>{inside}{mesh_xml()}</object>'


def settled(path):
    parts = [repair_part(part, allow_surface=False) for part in read_parts(path)]
    assert [violation for part in parts for violation in check_part(part)] == []
    return parts


def test_a_simple_job_is_read_bit_for_bit(tmp_path):
    mesh = trimesh.creation.icosphere(2, 7.3)
    path = pack(tmp_path / "job.3mf", f'<object id="1">{mesh_xml(mesh)}</object>', '<item objectid="1"/>')
    (part,) = settled(path)
    assert part.mesh.vertices.tobytes() == mesh.vertices.astype(np.float32).astype(np.float64).tobytes()
    assert np.array_equal(part.mesh.triangles, mesh.faces)
    assert (part.name, part.quantity, part.source, part.notes) == ("job", 1, str(path), ())
    assert part.volume_mm3 == pytest.approx(mesh.volume, rel=1e-6)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("micron", 0.001), ("centimeter", 10), ("inch", 25.4), ("foot", 304.8), ("meter", 1000)],
)
def test_every_unit_is_converted_to_millimetres_with_a_note(tmp_path, unit, factor):
    (part,) = settled(pack(tmp_path / "a.3mf", box_object(), '<item objectid="1"/>', unit=unit))
    assert np.ptp(part.mesh.vertices, axis=0) == pytest.approx([factor, 2 * factor, 3 * factor])
    assert "to millimetres" in part.notes[0]


def test_items_of_one_object_are_one_part_with_a_quantity(tmp_path):
    build = (
        '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 5 6 7"/><item objectid="1"/>'
        '<item objectid="1" transform="0 1 0 -1 0 0 0 0 1 9 9 9"/>'
    )
    first, turned = settled(pack(tmp_path / "a.3mf", box_object(more='name="box"'), build))
    assert (first.quantity, turned.quantity) == (2, 1)
    assert first.mesh.bounds[0] == pytest.approx([-0.5, -1, -1.5])
    assert np.ptp(turned.mesh.vertices, axis=0) == pytest.approx([2, 1, 3])


def test_a_mirrored_item_has_outward_normals(tmp_path):
    build = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    (part,) = read_parts(pack(tmp_path / "a.3mf", box_object(), build))
    assert part.mesh.signed_volume == pytest.approx(6)


def test_a_sheared_and_scaled_item_has_the_volume_of_its_determinant(tmp_path):
    build = '<item objectid="1" transform="2 0 0 0.5 1 0 0 0.25 3 0 0 0"/>'
    (part,) = settled(pack(tmp_path / "a.3mf", box_object(), build))
    assert part.volume_mm3 == pytest.approx(6 * 6)
    assert part.notes == ()


def test_nested_and_mirrored_components_become_one_part_in_the_right_position(tmp_path):
    resources = (
        box_object(1)
        + '<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/>'
        '<component objectid="1" transform="-1 0 0 0 1 0 0 0 1 -10 0 0"/></components></object>'
        '<object id="3" name="pair"><components>'
        '<component objectid="2" transform="0 1 0 -1 0 0 0 0 1 0 0 5"/></components></object>'
    )
    (part,) = settled(pack(tmp_path / "a.3mf", resources, '<item objectid="3"/>'))
    assert part.name == "pair"
    assert part.volume_mm3 == pytest.approx(12)
    assert part.notes == ()
    assert part.mesh.bounds[0] == pytest.approx([-1, -10.5, 3.5])
    assert part.mesh.bounds[1] == pytest.approx([1, 10.5, 6.5])


def test_components_that_overlap_count_once(tmp_path):
    resources = (
        box_object(1) + '<object id="2"><components><component objectid="1"/>'
        '<component objectid="1" transform="1 0 0 0 1 0 0 0 1 0.5 0 0"/></components></object>'
    )
    (part,) = settled(pack(tmp_path / "a.3mf", resources, '<item objectid="2"/>'))
    assert part.volume_mm3 == pytest.approx(9)


def test_name_number_and_metadata_are_kept(tmp_path):
    group = (
        '<metadatagroup><metadata name="v:alloy">Ti64</metadata>'
        '<metadata name="v:batch">1</metadata></metadatagroup>'
    )
    later = '<metadatagroup><metadata name="v:batch">2</metadata></metadatagroup>'
    item = f'<item objectid="1" partnumber="N-7">{later}</item>'
    (part,) = read_parts(pack(tmp_path / "a.3mf", box_object(more='name="Bracket.stl"', inside=group), item))
    assert (part.name, part.part_number) == ("Bracket", "N-7")
    space = "http://example.org/vendor"
    assert part.metadata == {(space, "alloy"): "Ti64", (space, "batch"): "2"}


def wishes(**values):
    lines = "".join(f'<metadata name="a:{name}">{value}</metadata>' for name, value in values.items())
    return f"<metadatagroup>{lines}</metadatagroup>"


def test_quantity_value_and_rotations_come_from_amprep_metadata(tmp_path):
    inside = wishes(quantity=3, value="12.5", rotations="z90")
    build = f'<item objectid="1"/><item objectid="1" partnumber="x">{wishes(quantity=2)}</item>'
    first, second = read_parts(pack(tmp_path / "a.3mf", box_object(inside=inside), build))
    assert (first.quantity, first.value, len(first.orientations.matrices)) == (3, 12.5, 4)
    assert (second.quantity, second.value) == (2, 12.5)
    assert first.metadata == {}


@pytest.mark.parametrize(
    "wrong",
    [{"quantity": "0"}, {"quantity": "many"}, {"quantity": "9999999999"}, {"value": "nan"}, {"value": "-1"},
     {"rotations": "some"}, {"rotations": "[[1]]"}],
)  # fmt: skip
def test_invalid_job_metadata_is_refused_by_name(tmp_path, wrong):
    path = pack(
        tmp_path / "a.3mf", box_object(more='name="box"', inside=wishes(**wrong)), '<item objectid="1"/>'
    )
    with pytest.raises(InputError, match=f"a.3mf: box: .*{next(iter(wrong))}") as caught:
        read_parts(path)
    assert "\n" not in str(caught.value)


MATERIALS = (
    '<basematerials id="8"><base name="Steel" displaycolor="#112233"/>'
    '<base name="Gold" displaycolor="#FFD70080"/></basematerials>'
    '<m:colorgroup id="9"><m:color color="#FF0000"/><m:color color="#00FF00FF"/></m:colorgroup>'
)


def test_a_base_material_gives_name_and_colour(tmp_path):
    resources = MATERIALS + box_object(more='pid="8" pindex="1"')
    (part,) = read_parts(pack(tmp_path / "a.3mf", resources, '<item objectid="1"/>'))
    assert (part.appearance.material, part.appearance.colour) == ("Gold", "#FFD70080")
    assert part.appearance.triangle_colours is None


def test_one_colour_on_all_triangles_is_the_colour_of_the_part(tmp_path):
    red = mesh_xml(colour=' pid="9" p1="0"')
    resources = f'{MATERIALS}<object id="1">{red}</object>'
    (part,) = read_parts(pack(tmp_path / "a.3mf", resources, '<item objectid="1"/>'))
    assert (part.appearance.material, part.appearance.colour) == (None, "#FF0000FF")


def test_different_colours_are_kept_for_each_corner_and_the_object_colours_the_rest(tmp_path):
    mesh = mesh_xml().replace('<triangle v1="', '<triangle pid="9" p1="0" p2="1" p3="1" v1="', 1)
    resources = f'{MATERIALS}<object id="1" pid="8" pindex="0">{mesh}</object>'
    (part,) = settled(pack(tmp_path / "a.3mf", resources, '<item objectid="1"/>'))
    colours = part.appearance.triangle_colours
    assert colours[0].tolist() == [0xFF0000FF, 0x00FF00FF, 0x00FF00FF]
    assert (colours[1:] == 0x112233FF).all()
    assert part.appearance.colour is None


def test_the_corners_of_a_mirrored_triangle_keep_their_colours(tmp_path):
    mesh = mesh_xml().replace('<triangle v1="', '<triangle pid="9" p1="0" p2="1" p3="1" v1="', 1)
    resources = f'{MATERIALS}<object id="1" pid="8" pindex="0">{mesh}</object>'
    build = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    (part,) = read_parts(pack(tmp_path / "a.3mf", resources, build))
    assert present(part.appearance.triangle_colours)[0].tolist() == [0x00FF00FF, 0x00FF00FF, 0xFF0000FF]
    assert part.mesh.triangles[0].tolist() == BOX.faces[0][::-1].tolist()


@pytest.mark.parametrize("kind", ["support", "solidsupport", "surface"])
def test_objects_that_are_not_printable_are_left_out_with_a_note(tmp_path, kind):
    other = box_object(2).replace('type="model"', f'type="{kind}" name="prop"')
    group = (
        '<object id="3"><components><component objectid="1"/><component objectid="2"/></components></object>'
    )
    (part,) = settled(pack(tmp_path / "a.3mf", box_object(1) + other + group, '<item objectid="3"/>'))
    assert part.volume_mm3 == pytest.approx(6)
    assert "left out 'prop'" in part.notes[0]


def test_a_build_of_supports_alone_is_refused(tmp_path):
    only = box_object(1).replace('type="model"', 'type="support"')
    with pytest.raises(InputError, match=r"nothing that can be printed .*support"):
        read_parts(pack(tmp_path / "a.3mf", only, '<item objectid="1"/>'))


def test_an_empty_build_is_refused(tmp_path):
    with pytest.raises(InputError, match="nothing that can be printed"):
        read_parts(pack(tmp_path / "a.3mf", box_object(1), ""))


def volumes(*kinds):
    lines = "".join(
        f'<volume firstid="{12 * i}" lastid="{12 * i + 11}"><metadata type="volume" key="name" value="v{i}"/>'
        f'<metadata type="volume" key="volume_type" value="{kind}"/></volume>'
        for i, kind in enumerate(kinds)
    )
    name = '<metadata type="object" key="name" value="Thing.stl"/>'
    config = f'<config><object id="1" instances_count="1">{name}{lines}</object></config>'
    return {"Metadata/Slic3r_PE_model.config": config}


def three_boxes():
    moved = [BOX.copy().apply_translation([4 * i, 0, 0]) for i in range(3)]
    return f'<object id="1" type="model">{mesh_xml(trimesh.util.concatenate(moved))}</object>'


def test_blockers_and_modifiers_of_prusaslicer_are_not_printed(tmp_path):
    files = volumes("ModelPart", "SupportBlocker", "ParameterModifier")
    build = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    (part,) = settled(pack(tmp_path / "a.3mf", three_boxes(), build, files=files))
    assert part.name == "Thing"
    assert part.volume_mm3 == pytest.approx(6)
    assert [(region.kind, region.name) for region in part.regions] == [("blocker", "v1"), ("lattice", "v2")]
    assert [region.mesh.signed_volume for region in part.regions] == pytest.approx([6, 6])
    assert [region.mesh.bounds[0][0] for region in part.regions] == pytest.approx([-4.5, -8.5])
    assert any("modifier 'v2'" in note for note in part.notes)


def test_a_negative_volume_is_refused_rather_than_printed(tmp_path):
    files = volumes("ModelPart", "NegativeVolume", "ModelPart")
    with pytest.raises(InputError, match="negative volume"):
        read_parts(pack(tmp_path / "a.3mf", three_boxes(), '<item objectid="1"/>', files=files))


def test_a_component_that_bambu_studio_calls_a_blocker_is_not_printed(tmp_path):
    resources = (
        box_object(1)
        + box_object(2)
        + '<object id="3"><components><component objectid="1"/>'
        + '<component objectid="2" transform="1 0 0 0 1 0 0 0 1 9 0 0"/></components></object>'
    )
    config = (
        '<config><object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype="support_blocker">'
        '<metadata key="name" value="no"/></part></object></config>'
    )
    files = {"Metadata/model_settings.config": config}
    (part,) = settled(pack(tmp_path / "a.3mf", resources, '<item objectid="3"/>', files=files))
    assert part.volume_mm3 == pytest.approx(6)
    assert [(region.kind, region.name) for region in part.regions] == [("blocker", "no")]
    assert part.regions[0].mesh.bounds[0][0] == pytest.approx(8.5)


def test_items_marked_as_not_printable_are_left_out_with_a_note(tmp_path):
    build = '<item objectid="1" printable="0"/><item objectid="1"/><item objectid="1" printable="0"/>'
    (part,) = read_parts(pack(tmp_path / "a.3mf", box_object(), build))
    assert part.quantity == 1
    assert part.notes == ("left out 2 items: the file says not to print",)


THUMBNAIL = (
    '<Relationship Target="/Metadata/thumbnail.png" Id="r2" '
    'Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"/>'
)


def test_a_relationship_to_a_missing_thumbnail_gives_a_warning_with_the_rule(tmp_path):
    path = pack(tmp_path / "a.3mf", box_object(), '<item objectid="1"/>', rels=relations(THUMBNAIL))
    (part,) = settled(path)
    assert part.notes == ()
    (warning,) = part.warnings
    assert "3MF core 2.1.1: the target of a relationship must be in the package" in warning


def test_a_file_that_lib3mf_refuses_for_its_materials_is_read_without_them(tmp_path):
    """Units, placements, metadata and names are as in a file without faults."""
    groups = (
        '<basematerials id="2"><base name="x" displaycolor="#FF0000"/></basematerials>'
        '<m:colorgroup id="3"><m:color color="#00FF00"/></m:colorgroup>'
        '<m:multiproperties id="4" pids="2 9"><m:multi pindices="0 0"/></m:multiproperties>'
    )
    box = box_object(more='name="box" pid="4" pindex="0"', inside=wishes(quantity=3))
    build = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 5 6 7"/>'
    (part,) = settled(pack(tmp_path / "a.3mf", groups + box, build, unit="inch"))
    assert (part.name, part.quantity, part.appearance.colour) == ("box", 3, None)
    assert part.volume_mm3 == pytest.approx(6 * 25.4**3)
    assert part.positions[0] == pytest.approx(np.array([5, 6, 7]) * 25.4)
    assert any("3MF materials 5" in warning for warning in part.warnings)
    assert any("read without colours and materials" in warning for warning in part.warnings)


def test_objects_in_another_part_of_the_package_are_found(tmp_path):
    other = (
        f'<?xml version="1.0" encoding="UTF-8"?><model unit="millimeter" {SPACES}>'
        f"<resources>{box_object(7)}</resources><build/></model>"
    )
    part_relations = relations(target="/3D/other.model")
    resources = (
        '<object id="1" p:UUID="10000000-0000-0000-0000-000000000001"><components>'
        '<component objectid="7" p:path="/3D/other.model" p:UUID="10000000-0000-0000-0000-000000000002"/>'
        "</components></object>"
    )
    files = {"3D/other.model": other, "3D/_rels/3dmodel.model.rels": part_relations}
    (part,) = settled(pack(tmp_path / "a.3mf", resources, '<item objectid="1"/>', files=files))
    assert part.volume_mm3 == pytest.approx(6)


def test_reading_agrees_with_trimesh_on_a_file_written_by_trimesh(tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(BOX, node_name="box", geom_name="box")
    scene.add_geometry(trimesh.creation.icosphere(1, 4), node_name="ball", geom_name="ball")
    path = tmp_path / "a.3mf"
    scene.export(path)
    volumes_read = sorted(part.volume_mm3 for part in settled(path))
    assert volumes_read == pytest.approx(sorted(mesh.volume for mesh in scene.dump()), rel=1e-6)


def test_reading_twice_gives_the_same_parts(tmp_path):
    path = pack(
        tmp_path / "a.3mf", three_boxes(), '<item objectid="1"/>', files=volumes("ModelPart", "ModelPart")
    )
    first, second = settled(path), settled(path)
    assert [part.mesh.digest for part in first] == [part.mesh.digest for part in second]


@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="PrusaSlicer is not installed")
def test_files_of_prusaslicers_command_line_are_read(tmp_path):
    BOX.export(tmp_path / "box.stl")
    command = ["prusa-slicer", "--export-3mf", "-o", str(tmp_path / "box.3mf"), str(tmp_path / "box.stl")]
    subprocess.run(command, check=True, capture_output=True)
    (part,) = settled(tmp_path / "box.3mf")
    assert (part.name, part.quantity) == ("box", 1)
    assert part.volume_mm3 == pytest.approx(6, rel=1e-5)
