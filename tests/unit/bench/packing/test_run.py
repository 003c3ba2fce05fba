"""The packing benchmarks read their instances correctly and report the result of the independent check."""

import json

import numpy as np
import pytest
from tests.shared.builds import box_mesh
from typer.testing import CliRunner

from amprep.bench.packing.container_loading import read_instances
from amprep.bench.packing.run import PackerRun, fill_ratio
from amprep.bench.packing.thesis_tables import FILL_ROWS, repeated_boxes, table_cell
from amprep.cli.app import app
from amprep.errors import InputError
from amprep.host import Host
from amprep.model import (
    Boxes,
    BuildVolume,
    ConvexPieces,
    Item,
    Packing,
    PackingProblem,
    Placement,
    Solid,
)


def test_mpv_prints_checked_instances_as_json():
    result = CliRunner().invoke(
        app, ["bench", "mpv", "--class", "1", "--n", "10", "--count", "2", "--time-limit", "2", "--json"]
    )
    record = json.loads(result.stdout)
    assert result.exit_code == 0
    assert [instance["name"] for instance in record["instances"]] == ["mpv_1_010_01", "mpv_1_010_02"]
    for instance in record["instances"]:
        assert instance["validated"]
        assert instance["builds"] >= instance["bound"]
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


def test_rotation_flags_give_the_allowed_orientations(tmp_path):
    (instance,) = read_instances(loading(tmp_path))
    turned = [np.abs(matrix) @ [3, 2, 1] for matrix in instance.problem.items[0].orientations.matrices]
    assert [side.tolist() for side in turned] == [[3, 2, 1], [1, 3, 2]]


def test_two_boxes_that_fill_a_container_exactly_are_packed(tmp_path):
    result = CliRunner().invoke(app, ["bench", "container-loading", str(loading(tmp_path)), "--json"])
    record = json.loads(result.stdout)
    assert record["instances"][0]["value"] == 12
    assert record["instances"][0]["status"] == "optimal"


@pytest.mark.parametrize("change", [{"X": "nan"}, {"X": "-3"}, {"COPIES": "1e9"}, {"COPIES": "100001"}])
def test_boxes_without_valid_sides_or_copies_are_rejected(tmp_path, change):
    with pytest.raises(InputError, match="container-loading"):
        read_instances(loading(tmp_path, **change))


def test_files_of_another_format_are_rejected(tmp_path):
    for text in ("", "[]", "{}", '{"instances": 3}', '{"instances": [{"items": []}]}'):
        (tmp_path / "other.json").write_text(text)
        with pytest.raises(InputError, match="expected"):
            read_instances(tmp_path / "other.json")


def test_the_thesis_tables_list_its_results_next_to_ours():
    arguments = ["--packer", "extreme-points", "--max-boxes", "25", "--time-limit", "2", "--json"]
    result = CliRunner().invoke(app, ["bench", "packing", *arguments])
    builds, fill = json.loads(result.stdout)
    assert result.exit_code == 0
    assert (builds["boxes"], fill["boxes"]) == ([15], [20, 25])
    assert builds["thesis"]["Tabu"] == ["0.04 s"]
    for table in (builds, fill):
        assert list(table["instances"]) == ["extreme-points"]
        assert all(instance["validated"] for instance in table["instances"]["extreme-points"])


def test_filling_counts_every_kind_of_bounding_volume():
    cube = box_mesh((0, 0, 0), (10, 10, 10))
    half = box_mesh((5, 0, 0), (10, 10, 10))
    volumes = (ConvexPieces((cube, half)), Solid(cube), Boxes([[0, 0, 0]], [[10, 10, 10]]))
    items = tuple(Item(part, 0, volume, 1.0) for part, volume in enumerate(volumes))
    problem = PackingProblem(items, BuildVolume([100, 10, 10]), "fill")
    places = tuple(Placement(item, np.eye(3), [20.0 * item, 0, 0]) for item in range(3))
    assert fill_ratio(problem, Packing((places,))) == pytest.approx((1500 + 1000 + 1000) / 10000)


def test_a_result_names_who_found_it_and_whether_the_solver_ran():
    host = Host.load(plugins_enabled=False)
    for params, finder in (
        ({"directions": 0}, "the solver did not run"),
        ({"start": "none"}, "the solver HiGHS"),
    ):
        run = PackerRun(host, host.choose("packer", "ip"), {"effort": 0.01, **params}, 20.0, 0)
        result = run.run(repeated_boxes(20, "fill"))
        assert result.found_by.endswith(finder)
        for shown in (result.line, table_cell(result)):
            assert finder in shown
        assert result.record["found_by"] == result.found_by
        assert result.processor_seconds > 0.0


def test_the_fill_table_also_shows_the_solver_without_a_start():
    assert {"ip", "ip, no start"} <= {row.label for row in FILL_ROWS}
