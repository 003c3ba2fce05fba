"""A build file contains its whole build; other and damaged files are refused in one line."""

import dataclasses
import io
import zipfile
from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.examples import examples

from amprep.errors import InputError
from amprep.model import (
    TARGETS,
    Build,
    BuildSettings,
    BuildVolume,
    Mesh,
    Orientations,
    Overrides,
    Part,
    PlacedPart,
    Region,
    SupportBody,
    Unsupported,
)
from amprep.model.supports.sizes import SupportSizes
from amprep.threemf import read_build, write_build
from amprep.threemf import write as writing
from amprep.threemf.build import record
from amprep.threemf.build.values import from_json, to_json

MODEL = "3D/3dmodel.model"


@pytest.fixture
def round_trip(tmp_path):
    def run(build):
        write_build(build, tmp_path / "build.3mf")
        return read_build(tmp_path / "build.3mf")

    return run


def differences(one, other, where="build"):
    """Return where two records differ by more than the rounding to float32 in a file."""
    if dataclasses.is_dataclass(one):
        pairs = [(getattr(one, each.name), getattr(other, each.name), each.name) for each in fields(one)]
    elif isinstance(one, Mapping):
        pairs = [(one[key], other.get(key), str(key)) for key in {**one, **other}]
    elif isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
        pairs = [(*each, str(index)) for index, each in enumerate(zip(one, other, strict=True))]
    elif isinstance(one, np.ndarray):
        same = (
            isinstance(other, np.ndarray) and one.shape == other.shape and np.allclose(one, other, atol=1e-5)
        )
        return [] if same else [where]
    else:
        return [] if one == other else [where]
    return [found for a, b, name in pairs for found in differences(a, b, f"{where}.{name}")]


@pytest.mark.parametrize("share", [False, True])
@pytest.mark.parametrize("target", TARGETS)
def test_a_written_build_is_read_back(make_build, round_trip, target, share):
    build = make_build(target, share=share)
    found = differences(build, round_trip(build))
    stored = {f"build.supports.{index}.stored" for index in range(2)}
    assert set(found) == {f"build.parts.{index}.recorded_digest" for index in range(3)} | stored


@pytest.mark.parametrize("target", TARGETS)
def test_reach_and_sizes_of_a_support_are_read_back(make_build, round_trip, target):
    build = make_build(target)
    own = replace(build.supports[1], reach=1.2, sizes=SupportSizes(0.8, 0.3, 1.5, 0.4, 2.0, 0.5))
    found = round_trip(replace(build, supports=(build.supports[0], own)))
    assert [(each.reach, each.sizes) for each in found.supports] == [(None, None), (1.2, own.sizes)]
    assert [found.settings.reach_of(each) for each in found.supports] == [build.settings.reach, 1.2]


def test_a_wall_without_thickness_is_read_back_as_such(make_build, round_trip):
    build = make_build(surface=True)
    assert [support.surface for support in round_trip(build).supports] == [True, False]


@pytest.mark.parametrize("target", TARGETS)
def test_a_build_without_supports_is_read(make_build, round_trip, target):
    build = replace(make_build(target), supports=(), unsupported=())
    assert len(differences(build, round_trip(build))) == 3


@pytest.mark.parametrize("target", TARGETS)
def test_copies_share_one_part_after_reading(make_build, round_trip, target):
    first, _, third = round_trip(make_build(target)).parts
    assert first.part is third.part


@pytest.mark.parametrize("share", [False, True])
@pytest.mark.parametrize("target", TARGETS)
def test_the_recorded_digest_is_that_of_the_geometry(make_build, round_trip, target, share):
    build = make_build(target, share=share)
    for made, placed in zip(build.parts, round_trip(build).parts, strict=True):
        assert placed.recorded_digest == placed.part.mesh.digest
        if not (share and target == "prusaslicer"):
            assert placed.recorded_digest == made.part.mesh.digest


wild = (
    st.floats(-1e6, 1e6) | st.floats(-300, 300) | st.floats(-1e-5, 1e-5) | st.sampled_from([0.0, -0.0, 16.0])
)


@pytest.mark.parametrize("target", ["generic", "prusaslicer"])
@examples(40, suppress=(HealthCheck.function_scoped_fixture,))
@given(
    vertices=arrays(float, (60, 3), elements=wild),
    shift=arrays(float, 3, elements=st.floats(-400, 400)),
    angle=st.floats(-4, 4),
)
def test_any_coordinates_keep_their_digest(round_trip, target, vertices, shift, angle):
    mesh = Mesh(vertices, np.arange(60).reshape(-1, 3))
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    parts = tuple(
        PlacedPart(name, Part(name, mesh, 1.0), place) for name, place in [("a", matrix), ("b", np.eye(4))]
    )
    build = Build(
        BuildSettings("x", BuildVolume((1, 1, 1)), target), parts, (SupportBody("both", mesh, (0, 1)),)
    )
    first, second = round_trip(build).parts
    assert first.recorded_digest == first.part.mesh.digest == mesh.digest
    assert second.recorded_digest == second.part.mesh.digest
    assert second.mesh.vertices == pytest.approx(vertices, rel=0, abs=1e-6 * (np.abs(vertices).max() + 600))


@given(
    st.builds(
        BuildSettings,
        build_id=st.text(),
        space=st.just(
            BuildVolume((100.0, 100.0, 50.5), "cylinder", [[1, 2, 3], [0, 0, 0]], [[4, 5, 6.5], [1, 1, 1]])
        ),
        target=st.sampled_from(TARGETS),
        printer=st.text(),
        supported=st.booleans(),
        **{
            each.name: st.floats(0.05, 5.0)  # within the bounds of all of them
            for each in fields(BuildSettings)
            if each.type is float
        },
    )
)
@examples(50)
def test_settings_are_recorded_exactly(rules):
    volume = from_json(to_json(record.volume_record(rules.space)))
    text = to_json(record.settings_record(rules))
    assert differences(rules, record.settings_of(from_json(text), record.volume_of(volume))) == []


def test_every_override_but_the_volume_makers_is_recorded():
    """A field added to `Overrides` must be added to the record."""
    names = [each.name for each in fields(Overrides) if each.name != "volumes"]
    given = Overrides(**{name: True if name == "supports" else 1.5 for name in names})
    text = to_json(record.part_record(replace(_part(), overrides=given)))
    assert differences(given, record.part_of(from_json(text), _part().mesh, None).overrides) == []


def test_the_record_does_not_contain_the_folder_of_the_job():
    here, there = (
        record.part_record(replace(_part(), source=f"{folder}/a.stl")) for folder in ("/home/a", "/b")
    )
    assert here == there


def _part():
    return Part("a", Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), 1.0)


@pytest.fixture
def edited(make_build, tmp_path):
    """Return a function that reads a build whose model text was edited."""

    def run(old, new, target="generic", count=1, **options):
        path = tmp_path / "edited.3mf"
        write_build(make_build(target, **options), path)
        with zipfile.ZipFile(path) as package:
            contents = {name: package.read(name) for name in package.namelist()}
        assert contents[MODEL].count(old.encode()) >= 1
        contents[MODEL] = contents[MODEL].replace(old.encode(), new.encode(), count)
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as package:
            for name, content in contents.items():
                package.writestr(name, content)
        path.write_bytes(packed.getvalue())
        return read_build(path)

    return run


@pytest.mark.parametrize("target", TARGETS)
def test_changed_geometry_does_not_have_the_recorded_digest(edited, target):
    placed = edited('z="2.000000"', 'z="2.010000"', target).parts[0]
    assert placed.recorded_digest != placed.part.mesh.digest


def test_a_moved_part_is_read_in_its_new_position(edited):
    assert edited("10.123456 20 3", "11 20 3").parts[0].matrix[:3, 3].tolist() == [11.0, 20.0, 3.0]


BROKEN = {
    "the settings are not JSON": ('{"build_id"', "{build_id"),
    "the settings are a list": ('amprep:settings" preserve="1">{', 'amprep:settings" preserve="1">[]{'),
    "JSON nests too deeply": (
        'amprep:unsupported" preserve="1">',
        'amprep:unsupported" preserve="1">' + "[" * 50_000,
    ),
    "a number is NaN": ('"clearance": 0.5', '"clearance": NaN'),
    "a number is infinite": ('"clearance": 0.5', '"clearance": 1e999'),
    "a number has 400 digits": ('"clearance": 0.5', '"clearance": ' + "9" * 400),
    "a number has 5000 digits": ('"clearance": 0.5', '"clearance": ' + "9" * 5000),
    "a number is a text": ('"clearance": 0.5', '"clearance": "0.5"'),
    "a number is true": ('"clearance": 0.5', '"clearance": true'),
    "a number is missing": ('"clearance": 0.5, ', ""),
    "a flag is a number": ('"supported": true', '"supported": 1'),
    "the target is unknown": ('"target": "generic"', '"target": "laser"'),
    "the build volume has no height": ('"size": [250, 210, 220]', '"size": [250, 210, 0]'),
    "the build volume has two sizes": ('"size": [250, 210, 220]', '"size": [250, 210]'),
    "the build volume has six sizes": ('"size": [250, 210, 220]', '"size": [250, 210, 220, 1, 2, 3]'),
    "a zone is ragged": ('"zones": [[0, 0, 0, 5, 5, 5]]', '"zones": [[0, 0, 0, 5, 5, 5], [1]]'),
    "a zone is a text": ('"zones": [[0, 0, 0, 5, 5, 5]]', '"zones": [["a", 0, 0, 5, 5, 5]]'),
    "the shape is unknown": ('"shape": "box"', '"shape": "ball"'),
    "the parts are missing": ("amprep:parts", "amprep:party"),
    "a part is a number": ('amprep:parts" preserve="1">[', 'amprep:parts" preserve="1">[7,'),
    "a part's notes are a text": ('"notes": ["turned inside out"]', '"notes": "turned"'),
    "a part's metadata have two columns": ('["", "Designer", "Ada"]', '["Designer", "Ada"]'),
    "a freedom is unknown": ('"freedom": "list"', '"freedom": "all"'),
    "a matrix has eight numbers": ("[[1, 0, 0, 0, 1, 0, 0, 0, 1]]", "[[1, 0, 0, 0, 1, 0, 0, 0]]"),
    "a region's triangle is negative": ('"triangles": [1, 3]', '"triangles": [-1, 3]'),
    "a piece has no record": ('"role": "part", "index": 0', '"role": "part"'),
    "a piece's role is unknown": ('"role": "support"', '"role": "helper"'),
    "two bodies have one index": ('"role": "part", "index": 1', '"role": "part", "index": 0'),
    "an index leaves a gap": ('"role": "part", "index": 2', '"role": "part", "index": 3'),
    "a piece is of no known part": ('"part": 1, "sha256"', '"part": 2, "sha256"'),
    "two parts have one label": ('"label": "bar"', '"label": "plate &amp; &lt;tray&gt;"'),
    "a reach is too small to sample": ('"reach": 1.5', '"reach": 1e-4'),
    "a reach is larger than any printer": ('"reach": 1.5', '"reach": 1e5'),
    "a reach of a support is too small": ('"holds": [0]', '"holds": [0], "reach": 0.01'),
    "a reach of a support is NaN": ('"holds": [0]', '"holds": [0], "reach": NaN'),
    "a size of a support is below 0": ('"holds": [0]', '"holds": [0], "sizes": {"neck_mm": -1}'),
    "an overlap is deeper than a part": ('"overlap": 0.1', '"overlap": 50'),
    "an overlap is below 0": ('"overlap": 0.1', '"overlap": -0.1'),
    "a gap is below 0": ('"gap_mm": 0.0', '"gap_mm": -1'),
    "a gap is larger than any printer": ('"gap_mm": 0.0', '"gap_mm": 1e30'),
    "a clearance is below 0": ('"clearance": 0.5', '"clearance": -3'),
    "a lift is larger than any printer": ('"lift": 3.0', '"lift": 1e9'),
    "a least area is below 0": ('"min_area_mm2": 0.5', '"min_area_mm2": -1'),
    "an angle of a part is above 89": ('"overhang_angle_deg": 30.0', '"overhang_angle_deg": 90'),
    "a volume is below 0": ('"volume_mm3": 800.0', '"volume_mm3": -1'),
    "the build volume is astronomical": ('"size": [250, 210, 220]', '"size": [250, 210, 1e300]'),
    "a region's triangle is none of the part": ('"triangles": [1, 3]', '"triangles": [1, 12]'),
    "a region's triangle is huge": ('"triangles": [1, 3]', '"triangles": [1, 4000000000]'),
    "a region paints without triangles": ('"mesh": [[', '"triangles": [1], "mesh": [['),
    "a region's mesh has no vertices": ('"mesh": [[', '"mesh": [[], [['),
    "a region's mesh is a number": ('"mesh": [[', '"mesh": [7, ['),
    "a listed point is astronomical": ("[4, 5, 6]", "[4, 5, 6e30]"),
    "a listed radius is below 0": ('"radius": 0.7', '"radius": -1'),
    "a listed radius is larger than any printer": ('"radius": 0.7', '"radius": 1e9'),
    "a listed area is below 0": ('"measure": 12.5', '"measure": -1'),
    "a support holds no known part": ('"holds": [0]', '"holds": [3]'),
    "a support holds half a part": ('"holds": [0]', '"holds": [0.5]'),
    "a listed region is of no part": ('"part": 2, "label"', '"part": 3, "label"'),
    "a listed region is of an unknown kind": ('"kind": "face"', '"kind": "hole"'),
    "a listed point has two coordinates": ("[4, 5, 6]", "[4, 5]"),
    "an item has no record": ("amprep:bodies", "amprep:bodis"),
    "an item has a piece too few": (
        ',\n{"role": "support", "index": 0',
        ']</metadata><metadata name="amprep:x">[{"a": 0',
    ),
}


@pytest.mark.parametrize("claim", BROKEN)
def test_a_damaged_record_is_refused_in_one_line(edited, claim):
    with pytest.raises(InputError, match=r"edited\.3mf: amprep's metadata in the file is damaged") as refused:
        edited(*BROKEN[claim])
    assert "\n" not in str(refused.value)


def test_a_painted_region_may_have_the_area_of_the_part_and_no_more(make_build, round_trip):
    build = make_build()
    plate = build.parts[0].part
    every = np.arange(len(plate.mesh.triangles), dtype=np.int32)
    for stretch, is_read in ((1.0, True), (1.1, False)):
        mesh = Mesh(plate.mesh.vertices * stretch, plate.mesh.triangles)
        part = replace(plate, regions=(Region("blocker", "painted", every, mesh),))
        parts = (replace(build.parts[0], part=part), *build.parts[1:])
        if is_read:
            assert len(round_trip(replace(build, parts=parts)).parts[0].part.regions) == 1
        else:
            with pytest.raises(InputError, match="a region paints"):
                round_trip(replace(build, parts=parts))


MISCOUNTED = {
    "too few vertices": ('"vertices": 8', '"vertices": 7'),
    "too many vertices": ('"vertices": 8', '"vertices": 9'),
    "too few triangles": ('"triangles": 12}', '"triangles": 11}'),
    "more than there are": ('"triangles": 12}', '"triangles": 2000000000}'),
    "negative": ('"triangles": 12}', '"triangles": -12}'),
    "not counted": (', "triangles": 12}', "}"),
    "moved by no matrix": ('"to_part": [', '"to_part": [1, '),
    "flattened": ('"to_part": [0, ', '"to_part": [0, "'),
}


@pytest.mark.parametrize("claim", MISCOUNTED)
def test_the_recorded_sections_must_cover_a_merged_mesh(edited, claim):
    with pytest.raises(InputError, match="is damaged"):
        edited(*MISCOUNTED[claim], target="prusaslicer", share=True)


def test_a_singular_matrix_to_part_coordinates_is_refused(edited, make_build, tmp_path):
    write_build(make_build("prusaslicer", share=True), tmp_path / "a.3mf")
    with zipfile.ZipFile(tmp_path / "a.3mf") as package:
        text = package.read(MODEL).decode()
    start = text.index('"to_part": [')
    given = text[start : text.index("]", start)]
    flat = '"to_part": [' + ", ".join(["0"] * 16)
    with pytest.raises(InputError, match="is damaged"):
        edited(given, flat, target="prusaslicer", share=True)


def test_another_format_version_is_refused_by_name(edited):
    with pytest.raises(InputError, match=r"format version 1, found '2'"):
        edited('amprep:format" preserve="1">1<', 'amprep:format" preserve="1">2<')


@pytest.mark.parametrize(
    ("old", "new"), [("amprep:format", "amprep:former"), ("schemas.amprep.dev", "example.com")]
)
def test_a_3mf_that_amprep_did_not_write_is_refused(edited, old, new):
    with pytest.raises(InputError, match="expected a build that amprep wrote"):
        edited(old, new)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<triangle v1="', '<triangle v1="9'),
        ("<vertices>", "<vertexes>"),
        ('objectid="1"', 'objectid="99"'),
        ('x="0.000000"', 'x="nan"'),
    ],
)
def test_a_model_that_lib3mf_refuses_is_an_error_of_one_line(edited, old, new):
    with pytest.raises(InputError) as refused:
        edited(old, new)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", [b"", b"PK\3\4 and no more", b"solid part\nendsolid"])
def test_a_file_that_is_not_a_package_is_refused(tmp_path, content):
    path = tmp_path / "job.3mf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"job\.3mf"):
        read_build(path)


def test_a_truncated_build_is_refused(make_build, tmp_path):
    path = tmp_path / "job.3mf"
    write_build(make_build(), path)
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(InputError, match=r"job\.3mf"):
        read_build(path)


@pytest.mark.parametrize("name", ["", "missing.3mf"])
def test_a_folder_or_a_missing_file_is_refused(tmp_path, name):
    with pytest.raises(InputError):
        read_build(tmp_path / name)


def test_unsupported_points_are_read_back_to_a_micrometre(make_build, round_trip):
    points = np.array([[1.23456789, -2.0, 1e-9], [1 / 3, 2 / 3, 200.123456789]])
    region = Unsupported(0, "edge 1", "edge", "capacity", 3.25, points, 0.71)
    read = round_trip(replace(make_build(), unsupported=(region,))).unsupported[0]
    assert np.abs(read.points - points).max() <= 0.5000001e-6
    assert (read.label, read.kind, read.reason, read.measure, read.radius) == (
        "edge 1",
        "edge",
        "capacity",
        3.25,
        0.71,
    )


def test_rotation_about_z_needs_no_matrices(make_build, round_trip):
    build = make_build()
    turned = replace(build.parts[0], orientations=Orientations("free", np.empty((0, 3, 3))))
    read = round_trip(replace(build, parts=(turned, *build.parts[1:]))).parts[0].orientations
    assert (read.freedom, read.matrices.shape) == ("free", (0, 3, 3))


@pytest.mark.parametrize("target", TARGETS)
def test_long_records_are_read(make_build, round_trip, target):
    """lib3mf cannot read a text of 64 KiB."""
    points = np.random.default_rng(7).uniform(0, 200, (20_000, 3))
    region = Unsupported(0, "é" * 30_000, "face", "capacity", 3.25, points, 0.7)
    build = make_build(target)
    plate = replace(build.parts[0].part, notes=("𝄞&" * 40_000,), name="&" * 70_000)
    build = replace(
        build, parts=(replace(build.parts[0], part=plate), *build.parts[1:]), unsupported=(region,)
    )
    assert len(differences(build, round_trip(build))) == 5  # digests of parts and supports


def test_a_build_is_readable_wherever_the_buffer_of_lib3mf_ends(make_build, tmp_path, monkeypatch):
    """Names with escaped characters near 64 KiB; some of these files would be unreadable without padding."""
    build, path = make_build(), tmp_path / "build.3mf"
    plate = build.parts[0].part

    def readable(length):
        noted = replace(build.parts[0], part=replace(plate, notes=("x" * length,)))
        write_build(replace(build, parts=(noted, *build.parts[1:])), path)
        try:
            return read_build(path).parts[0].part.notes == ("x" * length,)
        except InputError:
            return False

    lengths = range(58_000, 62_000, 100)
    assert all(map(readable, lengths))
    monkeypatch.setattr(writing, "is_readable", lambda path: True)
    assert not all(map(readable, lengths))
