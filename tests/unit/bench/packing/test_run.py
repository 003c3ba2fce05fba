"""The benchmarks' instances are the published ones, and the runner reports what the judge finds."""

import hashlib
import json

import numpy as np
import pytest
from typer.testing import CliRunner

from amprep.bench.packing.container_loading import read_loading
from amprep.bench.packing.instances import MPV_SIDE, mpv_instance
from amprep.cli.app import app
from amprep.errors import InputError

PUBLISHED = "0e6d9f5cd1e8d8f5b0897c27c654c1f3d976713423f5c756511f64ec22eb9419"


def sizes(class_, n, index):
    items = mpv_instance(class_, n, index).problem.items
    return np.array([item.volume.hi[0] for item in items]).astype(int).tolist()


def test_the_first_boxes_of_class_1_are_as_published():
    assert sizes(1, 50, 1)[:3] == [[39, 85, 72], [11, 84, 96], [36, 10, 34]]


def test_the_320_instances_have_the_digest_of_the_published_set():
    # one text per instance: "n W H D", then "w h d" per box, as in OR-Datasets' Martello2000
    sha = hashlib.sha256()
    for class_, side in MPV_SIDE.items():
        for n in (50, 100, 150, 200):
            for index in range(1, 11):
                rows = [[n, side, side, side], *sizes(class_, n, index)]
                sha.update("".join(" ".join(map(str, row)) + "\n" for row in rows).encode())
    assert sha.hexdigest() == PUBLISHED


def test_mpv_prints_judged_instances_as_json():
    result = CliRunner().invoke(
        app, ["bench", "mpv", "--class", "1", "--n", "10", "--count", "2", "--time-limit", "2", "--json"]
    )
    record = json.loads(result.stdout)
    assert result.exit_code == 0
    assert [instance["name"] for instance in record["instances"]] == ["mpv_1_010_01", "mpv_1_010_02"]
    for instance in record["instances"]:
        assert instance["validated"]
        assert instance["bins"] >= instance["bound"]
        assert instance["status"] in {"optimal", "feasible"}
        assert 0 <= instance["seconds"] < 5


FLAGS = {"ROTATION_XYZ": "1", "ROTATION_ZXY": "1"}


def loading(tmp_path, **changes):
    box = {"X": "3", "Y": "2", "Z": "1", "COPIES": "2", **FLAGS, **changes}
    file = tmp_path / "two.json"
    file.write_text(
        json.dumps({"instances": [{"container": {"X": "3", "Y": "2", "Z": "2"}, "items": [box]}]})
    )
    return file


def test_flags_say_which_side_lies_along_which_axis(tmp_path):
    (instance,) = read_loading(loading(tmp_path))
    turned = [np.abs(matrix) @ [3, 2, 1] for matrix in instance.problem.items[0].orientations.matrices]
    assert [side.tolist() for side in turned] == [[3, 2, 1], [1, 3, 2]]


def test_two_boxes_that_just_fill_a_container_are_packed(tmp_path):
    result = CliRunner().invoke(app, ["bench", "container-loading", str(loading(tmp_path)), "--json"])
    record = json.loads(result.stdout)
    assert record["instances"][0]["value"] == 12
    assert record["instances"][0]["status"] == "optimal"


@pytest.mark.parametrize("change", [{"X": "nan"}, {"X": "-3"}, {"COPIES": "1e9"}, {"COPIES": "100001"}])
def test_impossible_boxes_are_refused_in_a_line(tmp_path, change):
    with pytest.raises(InputError, match="container-loading"):
        read_loading(loading(tmp_path, **change))


def test_other_files_are_refused_in_a_line(tmp_path):
    for text in ("", "[]", "{}", '{"instances": 3}', '{"instances": [{"items": []}]}'):
        (tmp_path / "other.json").write_text(text)
        with pytest.raises(InputError, match="expected"):
            read_loading(tmp_path / "other.json")


def test_the_thesis_tables_have_its_columns_beside_ours():
    arguments = ["--packer", "extreme-points", "--most-boxes", "25", "--time-limit", "2", "--json"]
    result = CliRunner().invoke(app, ["bench", "packing", *arguments])
    builds, fill = json.loads(result.stdout)
    assert result.exit_code == 0
    assert (builds["boxes"], fill["boxes"]) == ([15], [20, 25])
    assert builds["thesis"]["Tabu"] == ["0.04 s"]
    for table in (builds, fill):
        assert list(table["instances"]) == ["extreme-points"]
        assert all(instance["validated"] for instance in table["instances"]["extreme-points"])
