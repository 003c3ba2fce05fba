"""``amprep bench supports`` measures routers and other solvers on generated scenes."""

import json

import pytest
from tests.shared.optional import present
from typer.testing import CliRunner

from amprep.bench.routing.run import THESIS_SECONDS, run_scene
from amprep.cli.app import app
from amprep.testing.support_scenes import SIDES


@pytest.mark.parametrize("router", sorted(THESIS_SECONDS))
def test_each_router_of_the_thesis_is_measured(router):
    (result,) = run_scene([router], "ball", "A", capacity=0, seed=1)
    assert result.validated
    assert result.connected == result.red_squares
    assert result.thesis_seconds == THESIS_SECONDS[router]["A"]
    assert router in result.line


def test_min_cost_flow_connects_as_many_squares_as_push_relabel_at_no_greater_cost():
    costly, cheap = run_scene(["push-relabel", "min-cost-flow"], "plate", "A", capacity=1, seed=0)
    assert costly.connected == cheap.connected
    assert present(cheap.cost) <= present(costly.cost)


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
    assert {"nodes", "edges", "seconds", "connected", "cost", "peak_mb"} <= set(result)


def test_the_command_prints_the_time_of_the_thesis_and_rejects_unknown_routers():
    line = bench("--size A --scene ball --router min-cost-flow")
    assert "thesis 0.017 s" in line.stdout
    assert bench("--size A --router nonsense").exit_code != 0


def test_rerouting_reduces_the_squares_in_use_by_more_than_40_percent():
    (result,) = run_scene(["shortest-paths"], "ball", "B", capacity=0, seed=0)
    assert present(result.squares_final) < 0.6 * present(result.squares_initial)
    assert present(result.max_paths_per_square) <= 9


def test_other_solvers_find_the_same_values_or_report_why_they_did_not_run(monkeypatch):
    monkeypatch.setitem(SIDES, "A", 10)
    routers = ["push-relabel", "min-cost-flow"]
    results = list(run_scene(routers, "plate", "A", capacity=1, seed=0, rivals=True))
    assert {"or-tools max-flow", "scipy max-flow", "networkx min-cost-flow"} < {e.router for e in results}
    for each in results:
        assert each.validated or "not installed" in each.notes[0]
        assert each.router in each.line


def test_escalation_connects_at_least_as_many_squares():
    run = bench("--size A --scene plate --router push-relabel --capacity 1 --escalate cut --json")
    (result,) = json.loads(run.stdout)["results"]
    assert result["validated"]
    assert result["connected"] >= bench_flow(
        "--size A --scene plate --router push-relabel --capacity 1 --json"
    )


def bench_flow(options):
    return json.loads(bench(options).stdout)["results"][0]["connected"]
