"""The record in a build file is exact, and a damaged one is refused in one line."""

import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.records import MODEL, differences

from amprep.errors import InputError
from amprep.model import (
    TARGETS,
    BuildSettings,
    BuildVolume,
    Mesh,
    Overrides,
    Part,
    Region,
)
from amprep.threemf import write_build
from amprep.threemf.build import record
from amprep.threemf.build.values import from_json, to_json


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
