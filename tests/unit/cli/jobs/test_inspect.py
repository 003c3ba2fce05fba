"""``amprep inspect`` says what is in a file and what is wrong with it, and compares bounding volumes."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.unit.report.test_documented import described, keys
from typer.testing import CliRunner

import amprep
from amprep.cli.app import app
from amprep.errors import InputError

ROOT = Path(__file__).parents[4]


@pytest.fixture
def bracket(tmp_path):
    """Return the path of an L-shaped part of 7 cm3."""
    base, arm = trimesh.creation.box((40, 10, 10)), trimesh.creation.box((10, 10, 40))
    arm.apply_translation((15, 0, 15))
    path = tmp_path / "bracket.stl"
    trimesh.boolean.union([base, arm]).export(path)
    return path


@pytest.fixture
def broken(tmp_path):
    """Return the path of a box without a lid."""
    box = trimesh.creation.box((10, 10, 10))
    box.update_faces(np.arange(len(box.faces)) > 1)
    path = tmp_path / "broken.stl"
    box.export(path)
    return path


def run(*arguments):
    return CliRunner().invoke(app, ["inspect", *map(str, arguments)])


def test_a_sound_part_is_described_with_exit_code_0(bracket):
    result = run(bracket, "--json", "-q", "--set", "packing.lift_mm=0")
    assert result.exit_code == 0, result.output
    record = json.loads(result.stdout)
    (part,) = record["parts"]
    assert part["mesh"]["volume_mm3"] == pytest.approx(7000)
    assert part["mesh"]["size_mm"] == pytest.approx([40, 10, 40])
    assert (part["solid"], part["problems"]) == (True, [])
    assert part["overhangs"]["on_plate_mm2"] == pytest.approx(400)
    assert {fit["fit"] for fit in part["printers"]} == {"as it lies"}
    assert record["files"][0]["unit"] == "none"


def test_an_open_part_is_described_with_exit_code_1(broken):
    result = run(broken, "-q", "--json")
    assert result.exit_code == 1, result.output
    (part,) = json.loads(result.stdout)["parts"]
    assert not part["solid"]
    assert part["mesh"]["open_edges"] == 4
    assert any("not a solid" in problem for problem in part["problems"])


def test_a_part_that_fits_the_named_printer_only_when_turned_is_a_problem(bracket):
    low = 'printer={size_mm=[60.0,60.0,20.0], name="low"}'
    result = run(bracket, "--set", low)
    assert result.exit_code == 1
    assert "it does not fit low with clearance 5 mm, lift 3 mm; it would fit" in " ".join(
        result.stdout.split()
    )


@pytest.mark.parametrize("name", ["nothing.stl", "noise.stl"])
def test_a_file_that_cannot_be_read_is_wrong_input(tmp_path, name):
    (tmp_path / "noise.stl").write_bytes(bytes(range(200)))
    with pytest.raises(InputError):
        amprep.inspect(tmp_path / name)


def test_one_unreadable_file_of_several_is_listed_with_exit_code_1(bracket, tmp_path):
    (tmp_path / "noise.stl").write_bytes(bytes(range(200)))
    result = run(tmp_path, "--json", "-q")
    assert result.exit_code == 1, result.output
    record = json.loads(result.stdout)
    assert [bool(file["problem"]) for file in record["files"]] == [False, True]
    assert [part["name"] for part in record["parts"]] == ["bracket"]


def test_a_mesh_that_cannot_be_used_hinders_no_other(bracket, tmp_path):
    flat = tmp_path / "flat.off"
    flat.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 0 1\n")
    record = amprep.inspect(flat, bracket, volumes="box")
    assert [bool(part.problems) for part in record.parts] == [True, False]
    assert [len(part.volumes) for part in record.parts] in ([0, 1], [1, 1])


def test_the_report_page_and_pictures_are_written_and_every_key_is_described(bracket, tmp_path):
    out = tmp_path / "out"
    result = run(bracket, "--volumes", "all", "--volumes", "mesh,box", "-o", out, "-q")
    assert result.exit_code == 0, result.output
    report = json.loads((out / "bracket.inspect.json").read_text(encoding="utf-8"))
    page = (ROOT / "docs" / "inspect.md").read_text(encoding="utf-8")
    assert set(keys(report)) - described(page) == set()
    volumes = {volume["makers"]: volume for volume in report["parts"][0]["volumes"]}
    assert volumes["box"]["ratio"] == pytest.approx(16000 / 7000)
    assert volumes["mesh,box"]["ratio"] == pytest.approx(16000 / 7000)
    assert volumes["mesh"]["ratio"] == pytest.approx(1.0)
    assert all(volume["contains_part"] for volume in volumes.values() if not volume["failure"])
    assert {path.name for path in out.iterdir()} >= {"bracket.inspect.html", "bracket.inspect.box.png"}


def test_the_page_offers_every_volume_and_escapes_names(bracket, tmp_path):
    evil = tmp_path / "<b>&x.stl"
    evil.write_bytes(bracket.read_bytes())
    amprep.inspect(evil, volumes=("box", "mesh"), output=tmp_path / "out")
    (path,) = (tmp_path / "out").glob("*.html")
    text = path.read_text(encoding="utf-8")
    model = json.loads(present(re.search(r'id="model">(.*?)</script>', text)))
    (view,) = model["builds"]
    assert [choice["name"] for choice in view["volumes"]] == ["box", "mesh"]
    assert len(view["volumes"][0]["shown"][0]["pieces"]) == 1
    assert "<b>" not in text
    HTMLParser().feed(text)


def present(match):
    assert match is not None
    return match.group(1)


def test_the_table_names_every_maker(bracket):
    result = run(bracket, "--volumes", "all")
    assert result.exit_code == 0, result.output
    for name in ("box", "mesh", "ratio", "seconds", "nothing wrong"):
        assert name in result.stdout


def test_the_python_function_returns_a_record(bracket):
    record = amprep.inspect(bracket, volumes="box", settings={"supports.overhang_angle_deg": 40})
    assert str(record) == "bracket: 0 problems"
    assert record.faults == 0
    (part,) = record.parts
    assert part.overhangs is not None
    assert part.overhangs.angle_deg == 40
