"""``amprep bench supports`` prints the thesis's table of support planning with one command."""

import json

import pytest
from tests.shared.optional import present
from typer.testing import CliRunner

from amprep.bench.routing.thesis_table import EDGES, NODES, ROUTERS, thesis_table
from amprep.cli.app import app


def bench(options):
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, ["bench", "supports", *options.split()])


def test_the_table_has_nodes_edges_and_the_times_of_three_routers():
    shown = bench("--input a --input b")
    assert shown.exit_code == 0
    for words in ("nodes", "edges", *ROUTERS, str(NODES["B"]), str(EDGES["A"]), "0.089 s", "0.325 s"):
        assert words in shown.stdout


def test_every_plan_is_judged_and_capacities_hold():
    (column,) = thesis_table(["C"], ROUTERS, capacity=4, seed=0, progress=lambda _: None)
    assert [result.router for result in column.results] == list(ROUTERS)
    assert all(result.validated and present(result.max_paths_per_square) <= 4 for result in column.results)
    assert len({result.connected for result in column.results}) == 1


def test_all_inputs_are_the_default(monkeypatch):
    asked: list[str] = []

    def table(inputs, *_, **__):
        asked.extend(inputs)
        return []

    monkeypatch.setattr("amprep.bench.routing.thesis_table.thesis_table", table)
    assert json.loads(bench("--json").stdout)["results"] == []
    assert asked == ["A", "B", "C", "D", "E"]


@pytest.mark.parametrize("options", ["--scene ball", "--rivals", "--escalate cut", "--input A --size A"])
def test_options_of_generated_parts_are_refused_in_the_table(options):
    run = bench(options)
    assert run.exit_code != 0
    assert "--size" in str(run.exception)
