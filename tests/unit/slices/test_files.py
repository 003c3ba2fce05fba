"""Files of slices, read back by readers that share no code with their writers."""

import io
import json
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from rich.console import Console
from tests.shared.cli_reader import read_cli, signed_area

import amprep
from amprep.cli.builds.slice import slice_
from amprep.errors import AmprepError, InputError
from amprep.report.slices.json_form import to_json
from amprep.report.slices.terminal import summary

LAYER = 0.5

WRONG = [
    (0.0, "cli", "thicker than 0"),
    (float("nan"), "cli", "thicker than 0"),
    (1e-9, "cli", "choose thicker ones"),
    (1.0, "stl", "choose one"),
]


@pytest.fixture
def build(make_build):
    return make_build(surface=True)


@pytest.mark.parametrize("form", ["cli", "cli-binary"])
def test_common_layer_interface(build, form, tmp_path):
    record = amprep.slice_build(build, LAYER, form, output=tmp_path)
    assert len(record.files) == 2
    for name, role in zip(record.files, ("part", "support"), strict=True):
        header, layers = read_cli(tmp_path / name)
        labels = [line.split(",")[1] for line in header if line.startswith("$$LABEL/")]
        bodies = [each for each in record.bodies if each.role == role]
        assert len(labels) == len(bodies)
        assert f"$$LAYERS/{record.layers + 1}" in header
        assert [z for z, _ in layers] == pytest.approx(np.arange(record.layers + 1) * LAYER)
        assert layers[0][1] == []
        for i, (_, lines) in enumerate(layers[1:]):
            area = 0.0
            for _, way, points in lines:
                if way == 2:
                    continue
                assert (points[0] == points[-1]).all()
                own = signed_area(points[:-1])
                assert (own > 0) == (way == 1)
                area += own
            assert area == pytest.approx(record.area_mm2(role)[i], abs=0.01)
    assert any(way == 2 for _, lines in layers for _, way, _ in lines) == any(
        each.lines_mm for each in record.bodies
    )


def test_areas_add_up_to_the_volumes(build, tmp_path):
    record = amprep.slice_build(build, 0.02, "svg", output=tmp_path)
    for each in record.bodies:
        assert each.area_mm2.sum() * 0.02 == pytest.approx(each.volume_mm3, rel=1e-3, abs=1e-9)
        assert (each.lines_mm > 0.0) == (each.volume_mm3 == 0.0)


def test_pictures_are_few_and_show_each_body(build, tmp_path):
    record = amprep.slice_build(build, 0.01, "svg", output=tmp_path)
    assert record.layers > 100
    assert len(record.files) == 100 == len(list(tmp_path.iterdir()))
    root = ET.parse(tmp_path / record.files[0]).getroot()
    paths = [each for each in root if each.tag.endswith("path")]
    assert {each[0].text for each in paths} <= {each.name for each in record.bodies}
    area = 0.0
    for path in paths:
        for text in re.findall(r"M([^MZ]*)Z", path.get("d")):
            points = np.array(text.split(), float).reshape(-1, 2)
            area -= signed_area(points)  # the y axis leads down
    assert area == pytest.approx(record.area_mm2("part")[0] + record.area_mm2("support")[0], abs=0.01)


def test_lib3mf_reads_the_slices_in_its_strict_mode(build, tmp_path):
    lib3mf = pytest.importorskip("lib3mf")
    record = amprep.slice_build(build, LAYER, "3mf-slice", output=tmp_path)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / record.files[0]))
    assert [reader.GetWarning(i) for i in range(reader.GetWarningCount())] == []
    objects = model.GetMeshObjects()
    for body in record.bodies:
        assert objects.MoveNext()
        thing = objects.GetCurrentMeshObject()
        assert thing.GetName() == body.name.replace("&", "_").replace("<", "_").replace(">", "_")
        stack = thing.GetSliceStack()
        assert stack.GetSliceCount() == record.layers
        for layer in range(record.layers):
            own, area = stack.GetSlice(layer), 0.0
            points = np.array([list(each.Coordinates) for each in own.GetVertices()], float)
            for k in range(own.GetPolygonCount()):
                ring = own.GetPolygonIndices(k)
                if body.volume_mm3:
                    assert ring[0] == ring[-1]
                    area += signed_area(points[ring[:-1]])
            assert area == pytest.approx(body.area_mm2[layer], abs=0.01)


def test_wrong_demands_are_refused_and_leave_nothing(build, tmp_path):
    for layer, form, words in WRONG:
        with pytest.raises(InputError, match=words):
            amprep.slice_build(build, layer, form, output=tmp_path)
    for form in ("cli", "svg", "3mf-slice"):
        with pytest.raises(AmprepError, match="ended early"):
            amprep.slice_build(build, 0.1, form, output=tmp_path, time_limit_s=0.0)
    assert list(tmp_path.iterdir()) == []


def test_names_that_a_header_cannot_hold(build, tmp_path):
    part = replace(build.parts[0], label="a,b/c\n$$HEADEREND é")
    record = amprep.slice_build(replace(build, parts=(part,), supports=()), LAYER, output=tmp_path)
    header, layers = read_cli(tmp_path / record.files[0])
    assert [line for line in header if line.startswith("$$LABEL/")] == ["$$LABEL/1,a_b_c___HEADEREND ?"]
    assert len(layers) == record.layers + 1


def test_json_and_table(build, tmp_path):
    record = amprep.slice_build(build, LAYER, output=tmp_path)
    values = to_json(record)
    assert len(values["parts_area_mm2"]) == values["layers"] == record.layers
    assert [each["name"] for each in values["bodies"]] == [each.name for each in record.bodies]
    printed = io.StringIO()
    Console(width=200, file=printed).print(summary(record))
    assert all(each.name in printed.getvalue() for each in record.bodies)
    assert record.folder == Path(tmp_path)


def test_the_command_writes_beside_the_build_and_prints_json(build, tmp_path, capsys):
    file = amprep.write(build, tmp_path / "job.build-1.3mf")
    slice_(file, LAYER, as_json=True, progress="lines")
    said = capsys.readouterr()
    values = json.loads(said.out)
    assert sorted(values["files"]) == sorted(each.name for each in tmp_path.iterdir() if each != file)
    assert json.loads(said.err.splitlines()[-1])["fraction"] == 1.0
