"""``amprep orient`` proposes orientations in a table and as JSON."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.unit.report.test_documented import described, keys
from typer.testing import CliRunner

import amprep
from amprep.cli.app import app

ROOT = Path(__file__).parents[4]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Return the path of a table that is drawn on its leg."""
    top = trimesh.creation.box(bounds=[[-10, -10, 10], [10, 10, 12]])
    solid = trimesh.boolean.union([top, trimesh.creation.box(bounds=[[-2, -2, 0], [2, 2, 11]])])
    path = tmp_path_factory.mktemp("parts") / "table.stl"
    solid.export(path)
    return path


def run(*arguments):
    return CliRunner().invoke(app, ["orient", *map(str, arguments)])


def test_json_has_proposals_and_every_key_is_documented(table):
    result = run(table, "--json", "-q", "--effort", "fast", "--printer", "Prusa MK4")
    assert result.exit_code == 0, result.output
    record = json.loads(result.stdout)
    (part,) = record["parts"]
    best = part["proposals"][0]
    assert best["rotation"][2] == [0.0, 0.0, -1.0]
    assert (best["shadow_mm3"], part["drawn"]["shadow_mm3"] > 3000) == (0.0, True)
    page = (ROOT / "docs" / "orientation.md").read_text(encoding="utf-8")
    assert set(keys(record)) - described(page) == set()


def test_the_table_lists_proposals_and_the_part_as_drawn(table):
    result = run(table, "--effort", "fast", "--printer", "Prusa MK4", "--tilt", "20")
    assert result.exit_code == 0, result.output
    assert "directions tried" in result.output
    assert re.search(r"^ drawn +0\.0", result.output, re.MULTILINE)


def test_wrong_faces_are_refused_in_one_line(table):
    result = CliRunner().invoke(app, ["orient", str(table), "-q", "--face-up", "lid"])
    assert "no faces called 'lid'" in str(result.exception)


def test_python_and_command_line_propose_the_same(table):
    record = amprep.orient(table, effort="fast", printer="Prusa MK4")
    shown = json.loads(run(table, "--json", "-q", "--effort", "fast", "--printer", "Prusa MK4").stdout)
    rotations = [each["rotation"] for each in shown["parts"][0]["proposals"]]
    assert np.allclose(rotations, [each.rotation for each in record.parts[0].proposals])


def test_the_example_of_the_page_runs(table, monkeypatch):
    monkeypatch.chdir(table.parent)
    page = (ROOT / "docs" / "orientation.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(code, "orientation.md", "exec"), {})


@pytest.mark.parametrize("wrong", [{"effort": "quick"}, {"tilt_deg": 200.0}])
def test_wrong_arguments_are_refused(table, wrong):
    with pytest.raises(amprep.errors.JobError, match=next(iter(wrong))):
        amprep.orient(table, **wrong)


def test_page_report_and_picture_show_every_orientation(table, tmp_path):
    from PIL import Image

    result = run(table, "-q", "--effort", "fast", "--printer", "Prusa MK4", "-o", tmp_path)
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"table.orient.{suffix}" for suffix in ("html", "json", "png")
    ]
    record = json.loads((tmp_path / "table.orient.json").read_text(encoding="utf-8"))
    assert record["report_files"] == ["table.orient.html", "table.orient.json", "table.orient.png"]
    count = len(record["parts"][0]["proposals"]) + 1
    picture = np.asarray(Image.open(tmp_path / "table.orient.png"), float)
    side = picture.shape[0]
    assert picture.shape == (side, side * count, 3)
    red = (picture[..., 0] > 1.4 * picture[..., 1]).reshape(side, count, side).sum(axis=(0, 2))
    assert red[0] == 0, "upside down nothing needs support"
    assert red[-1] > 100, "as drawn the top does"
    page = (tmp_path / "table.orient.html").read_text(encoding="utf-8")
    assert all(f'"table, {name}"' in page for name in ("1", "2", "drawn"))
    assert page.count("data:image/png;base64,") == 1
