"""The scenes of ``amprep bench supports`` and what it prints."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from amprep.bench.routing.run import THESIS_SECONDS, run_scene
from amprep.bench.routing.scenes import SCENES, SIDES, count_graph, scene
from amprep.cli.app import app
from amprep.errors import InputError
from amprep.model.supports import Voxel

THESIS_NODES = {"A": 8_196, "B": 27_670, "C": 62_708, "D": 1_110_380, "E": 6_424_582}


@pytest.mark.parametrize("size", SIDES)
def test_sizes_are_the_thesis_s_within_5_percent(size):
    n = SIDES[size]
    assert (n + 1) * n**2 == pytest.approx(THESIS_NODES[size], rel=0.05)


@pytest.mark.parametrize("name", SCENES)
def test_red_squares_are_bottoms_of_black_cubes_over_white_ones(name):
    task = scene(name, 30)
    plane, y, x = task.red.T
    assert len(plane) > 50
    assert (task.voxels[plane, y, x] == Voxel.OCCUPIED).all()
    assert (task.voxels[plane - 1, y, x] == Voxel.FREE).all()


def test_a_ball_has_the_volume_of_a_ball():
    assert (scene("ball", 40).voxels == Voxel.OCCUPIED).mean() == pytest.approx(
        4 / 3 * np.pi * 0.28**3, rel=0.02
    )


def test_the_graph_is_counted_as_white_cubes_and_white_neighbours():
    """Without occupied voxels: 4 voxels a layer, each with itself and two neighbours."""
    task = scene("ball", 2)
    assert (task.voxels == Voxel.FREE).all()
    assert count_graph(task) == (3 * 4, 2 * 4 * 3)


def test_an_unknown_scene_is_named():
    with pytest.raises(InputError, match="ball, two-balls, plate, got 'voxel'"):
        scene("voxel", 10)


@pytest.mark.parametrize("router", sorted(THESIS_SECONDS))
def test_every_router_of_the_thesis_is_measured(router):
    (result,) = run_scene([router], "ball", "A", capacity=0, seed=1)
    assert result.validated
    assert result.flow == result.reds
    assert result.thesis_seconds == THESIS_SECONDS[router]["A"]
    assert router in result.line


def test_min_cost_flow_serves_as_many_as_push_relabel_at_no_greater_cost():
    costly, cheap = run_scene(["push-relabel", "min-cost-flow"], "plate", "A", capacity=1, seed=0)
    assert costly.flow == cheap.flow
    assert cheap.cost <= costly.cost


def bench(options):
    return CliRunner().invoke(app, ["bench", "supports", *options.split(" ")])


def test_the_command_prints_json():
    run = bench("--size a --scene ball --router push-relabel --capacity 1 --json")
    assert run.exit_code == 0
    (result,) = json.loads(run.stdout)["results"]
    assert {
        "router": "push-relabel",
        "scene": "ball",
        "size": "A",
        "validated": True,
    }.items() <= result.items()
    assert {"nodes", "edges", "seconds", "flow", "cost", "peak_mb"} <= set(result)


def test_the_command_prints_lines_and_refuses_unknown_routers():
    line = bench("--size A --scene ball --router min-cost-flow")
    assert "thesis 0.017 s" in line.stdout
    assert bench("--size A --router nonsense").exit_code != 0


def test_shortest_paths_tells_how_many_squares_its_first_paths_took():
    (result,) = run_scene(["shortest-paths"], "ball", "B", capacity=0, seed=0)
    assert result.squares_final < 0.6 * result.squares_first
    assert result.most_in_a_square <= 9


def test_rivals_find_the_same_values_or_say_why_they_did_not_run(monkeypatch):
    monkeypatch.setitem(SIDES, "A", 10)
    routers = ["push-relabel", "min-cost-flow"]
    results = list(run_scene(routers, "plate", "A", capacity=1, seed=0, rivals=True))
    assert {"or-tools max-flow", "scipy max-flow", "networkx min-cost-flow"} < {e.router for e in results}
    for each in results:
        assert each.validated or each.notes == ("not installed",)
        assert each.router in each.line


def test_escalation_is_asked_for():
    run = bench("--size A --scene plate --router push-relabel --capacity 1 --escalate cut --json")
    (result,) = json.loads(run.stdout)["results"]
    assert result["validated"]
    assert result["flow"] >= bench_flow("--size A --scene plate --router push-relabel --capacity 1 --json")


def bench_flow(options):
    return json.loads(bench(options).stdout)["results"][0]["flow"]
