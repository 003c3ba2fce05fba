"""A build file states the same build in every dialect, in the form that its reader understands."""

import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from amprep.errors import AmprepError
from amprep.files import replacing
from amprep.model import TARGETS, Mesh, SupportBody
from amprep.threemf import write as writing
from amprep.threemf import write_build
from amprep.threemf.build.identifier import read_identifier
from amprep.threemf.write import metadata as writing_metadata

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


@pytest.fixture
def written(make_build, tmp_path):
    """Return a function that writes a build and returns its path."""

    def write(build_or_target="generic", **options):
        build = (
            make_build(build_or_target, **options) if isinstance(build_or_target, str) else build_or_target
        )
        path = tmp_path / "job.build-1.3mf"
        write_build(build, path)
        return path

    return write


def entry(path, name="3D/3dmodel.model"):
    with zipfile.ZipFile(path) as package:
        return package.read(name).decode()


def model_of(path):
    return ET.fromstring(entry(path))


def objects_of(path):
    return {each.get("id"): each for each in model_of(path).iter(f"{CORE}object")}


def items_of(path):
    """Return the objects of each build item: its components', or its own."""
    objects = objects_of(path)
    for item in model_of(path).iter(f"{CORE}item"):
        target = objects[item.get("objectid")]
        components = [objects[each.get("objectid")] for each in target.iter(f"{CORE}component")]
        yield components or [target]


def placed_corners(build):
    meshes = [placed.mesh for placed in build.parts] + [support.mesh for support in build.supports]
    return np.vstack([mesh.vertices for mesh in meshes])


@pytest.mark.parametrize("target", TARGETS)
def test_equal_builds_give_equal_bytes(make_build, tmp_path, target):
    for name in ("first", "second"):
        write_build(make_build(target), tmp_path / name)
    assert (tmp_path / "first").read_bytes() == (tmp_path / "second").read_bytes()


def test_a_different_build_has_different_identifiers(make_build, written):
    first = entry(written(make_build()))
    build = make_build()
    second = entry(written(replace(build, settings=replace(build.settings, build_id="job.build-2"))))
    uuids = [set(text.split("UUID=")[1:]) for text in (first, second)]
    assert not {each[:38] for each in uuids[0]} & {each[:38] for each in uuids[1]}


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("share", [False, True])
def test_lib3mf_reads_every_file_in_strict_mode_without_warnings(written, target, share):
    import lib3mf

    reader = lib3mf.get_wrapper().CreateModel().QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(written(target, share=share)))
    assert reader.GetWarningCount() == 0


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("share", [False, True])
def test_trimesh_finds_every_part_and_support_in_its_position(make_build, written, target, share):
    corners = placed_corners(make_build(target, share=share))
    scene = trimesh.load(written(target, share=share))
    assert scene.bounds == pytest.approx(np.array([corners.min(axis=0), corners.max(axis=0)]), abs=1e-5)


@pytest.mark.parametrize("target", TARGETS)
def test_the_file_is_in_millimetres(written, target):
    assert model_of(written(target)).get("unit") == "millimeter"


def test_generic_puts_each_part_and_its_supports_in_one_components_object(written):
    items = [[(each.get("name"), each.get("type")) for each in item] for item in items_of(written())]
    assert items == [
        [("plate & <tray>", "model"), ("support 1 of plate", "solidsupport")],
        [("bar", "model"), ("support 2", "solidsupport")],
        [("plate & <tray>", "model")],
    ]


def test_a_support_shared_by_two_parts_puts_both_in_one_components_object(written):
    items = [[each.get("name") for each in item] for item in items_of(written(share=True))]
    assert items[1] == ["bar", "plate & <tray>", "support 2"]


def test_copies_share_the_mesh_of_their_part(written):
    first, _, third = items_of(written())
    assert first[0].get("id") == third[0].get("id")


def test_a_wall_without_thickness_has_the_type_that_machines_do_not_fill(written):
    first = next(items_of(written(surface=True)))
    assert [each.get("type") for each in first] == ["model", "support"]


@pytest.mark.parametrize(("target", "kind"), [("generic", "surface"), ("prusaslicer", "model")])
def test_a_part_that_is_not_a_solid_has_the_type_surface_except_for_prusaslicer(
    make_build, written, target, kind
):
    build = make_build(target)
    sheet = replace(build.parts[1].part, is_solid=False)
    path = written(
        replace(build, parts=(build.parts[0], replace(build.parts[1], part=sheet), build.parts[2]))
    )
    assert [each[0].get("type") for each in items_of(path)] == ["model", kind, "model"]


def test_a_document_that_lib3mf_refuses_is_an_error_of_one_line(make_build, written, monkeypatch):
    monkeypatch.setattr(writing_metadata, "STANDARD_NAMES", frozenset(["not a standard name"]))
    with pytest.raises(AmprepError, match=r"lib3mf refuses it"):
        written(make_build())


@pytest.mark.parametrize("target", ["prusaslicer", "cura"])
def test_walls_without_thickness_are_refused_for_slicers(written, target, tmp_path):
    with pytest.raises(AmprepError, match=r"support 1 of plate.*wall_mm"):
        written(target, surface=True)
    assert not list(tmp_path.iterdir())


def test_cura_finds_all_supports_and_no_part_by_its_own_prefix(written):
    path = written("cura")
    assert 'xmlns:cura="http://software.ultimaker.com/xml/cura/3mf/2015/10"' in entry(path)
    marked = {
        each.get("name"): [data.text for data in each.iter() if data.get("name") == "cura:support_mesh"]
        for item in items_of(path)
        for each in item
    }
    assert marked == {"plate & <tray>": [], "bar": [], "support 1 of plate": ["True"], "support 2": ["True"]}


@pytest.mark.parametrize("share", [False, True])
def test_prusaslicer_gets_only_objects_of_type_model_on_the_plate(written, share):
    path = written("prusaslicer", share=share)
    assert {each.get("type") for each in objects_of(path).values()} == {"model"}
    assert {each.get("id") for item in items_of(path) for each in item} == set(objects_of(path))
    assert '<metadata name="slic3rpe:Version3mf" preserve="1">1</metadata>' in entry(path)


def test_prusaslicer_volumes_are_the_triangle_ranges_of_parts_and_supports(written):
    path = written("prusaslicer", share=True)
    config = ET.fromstring(entry(path, "Metadata/Slic3r_PE_model.config"))
    volumes = [
        [
            (each.get("firstid"), each.get("lastid"), *(data.get("value") for data in each))
            for each in target.iter("volume")
        ]
        for target in config.iter("object")
    ]
    assert volumes == [
        [("0", "11", "plate & <tray>", "ModelPart"), ("12", "23", "support 1 of plate", "ModelPart")],
        [
            ("0", "11", "bar", "ModelPart"),
            ("12", "23", "plate & <tray>-2", "ModelPart"),
            ("24", "35", "support 2", "ModelPart"),
        ],
    ]
    assert {each.get("id") for each in config.iter("object")} == set(objects_of(path))


def test_prusaslicer_shows_copies_without_supports_as_instances(make_build, written):
    path = written(replace(make_build("prusaslicer"), supports=()))
    first, bar, third = items_of(path)
    assert first[0].get("id") == third[0].get("id") != bar[0].get("id")
    assert len(objects_of(path)) == 2


@pytest.mark.parametrize("target", TARGETS)
def test_names_contain_part_build_and_identifier(written, target):
    path = written(target)
    names = [each.get("name") for each in objects_of(path).values()]
    own = read_identifier(path)
    assert {f"plate & <tray> (job.build-1 {own})", f"bar (job.build-1 {own})"} <= set(names)


@pytest.mark.parametrize("target", TARGETS)
def test_metadata_of_a_part_is_written(written, target):
    plate = next(each for each in objects_of(written(target)).values() if each.get("partnumber"))
    kept = {data.get("name").rpartition(":")[2]: data.text for data in plate.iter(f"{CORE}metadata")}
    assert plate.get("partnumber") == "PN-7"
    assert kept == {"Designer": "Ada", "order": 'hä "4711"'}  # and no job instruction such as a quantity


@pytest.mark.parametrize("target", TARGETS)
def test_colours_and_material_are_those_of_the_part(make_build, written, target):
    text = entry(written(target))
    assert '<base name="Ti64" displaycolor="#FF8000FF"/>' in text
    colours = make_build().parts[0].part.appearance.triangle_colours
    assert all(f'<m:color color="#{value:08X}"/>' in text for value in np.unique(colours).tolist())


def test_coordinates_and_placements_keep_more_digits_than_lib3mf_writes(make_build, written):
    """lib3mf turns 138.127964 into 138.127968 and a placement at 123.456789 into one at 123.457."""
    build = make_build()
    exact = Mesh(build.parts[1].part.mesh.vertices + 138.127964, build.parts[1].part.mesh.triangles)
    bar = replace(build.parts[1], part=replace(build.parts[1].part, mesh=exact))
    text = entry(written(replace(build, parts=(build.parts[0], bar, build.parts[2]))))
    assert 'x="138.227964"' in text
    assert 'transform="1 0 0 0 1 0 0 0 1 123.456789 150 3"' in text


@pytest.mark.parametrize("name", ["tab\there", "bell\a", "half \ud800 pair", "not a character \uffff", ""])
@pytest.mark.parametrize("target", TARGETS)
def test_any_name_makes_well_formed_xml(make_build, written, name, target):
    build = make_build(target)
    named = replace(build.parts[1], label=name, part=replace(build.parts[1].part, name=name))
    assert model_of(written(replace(build, parts=(build.parts[0], named, build.parts[2])))) is not None


@pytest.mark.parametrize(
    ("vertices", "triangles", "why"),
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [], "no triangles"),
        ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "not finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1e9, 0]], [[0, 1, 2]], "beyond 1e9 mm"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]], "does not exist"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, -1]], "does not exist"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 0]], "same vertex twice"),
    ],
)
def test_a_mesh_that_3mf_cannot_store_is_refused_by_name(
    make_build, written, tmp_path, vertices, triangles, why
):
    body = SupportBody("bad support", Mesh(vertices, np.reshape(triangles, (-1, 3))), (0,))
    with pytest.raises(AmprepError, match=rf"bad support.*{why}"):
        written(replace(make_build(), supports=(body,)))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("held", [(), (3,), (-1,)])
def test_a_support_must_hold_parts_of_its_build(make_build, written, held):
    body = SupportBody("stray", make_build().supports[0].mesh, held)
    with pytest.raises(AmprepError, match="stray"):
        written(replace(make_build(), supports=(body,)))


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, AmprepError])
def test_an_interruption_leaves_the_old_file_and_nothing_else(make_build, tmp_path, monkeypatch, error):
    path = tmp_path / "job.build-1.3mf"
    path.write_bytes(b"of yesterday")

    def broken(body, palette, object_ids):
        yield b"<mesh>"
        raise error

    monkeypatch.setattr(writing, "mesh_text", broken)
    with pytest.raises(error):
        write_build(make_build(), path)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"of yesterday"]


def test_a_missing_folder_is_an_error_of_one_line(make_build, tmp_path):
    with pytest.raises(AmprepError, match=r"^cannot write .*nowhere.*$"):
        write_build(make_build(), tmp_path / "nowhere" / "job.3mf")


def test_a_file_appears_only_when_it_is_complete(tmp_path):
    path = tmp_path / "file"
    with replacing(path) as temporary:
        temporary.write_text("half")
        assert not path.exists()
        temporary.write_text("whole")
    assert path.read_text(encoding="utf-8") == "whole"
    assert list(tmp_path.iterdir()) == [path]


def test_parts_chained_by_shared_supports_form_one_group(make_build, written):
    """One support holds parts 0 and 1, another 1 and 2."""
    build = make_build()
    chained = tuple(
        replace(body, parts=parts) for body, parts in zip(build.supports, [(0, 1), (1, 2)], strict=True)
    )
    items = list(items_of(written(replace(build, supports=chained))))
    assert [len(item) for item in items] == [5]
