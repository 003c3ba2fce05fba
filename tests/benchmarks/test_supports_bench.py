"""Time of the stages of support planning on named scenes; the ratios to other solvers have limits."""

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.bench.routing.run import run_scene
from amprep.checks.supports.plan import check_plan
from amprep.geometry.overhangs.find import find_overhangs
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import holding_voxels, met_voxels
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.testing.support_scenes import SIDES, support_scene

ROUTERS = ["push-relabel", "min-cost-flow", "shortest-paths"]


def route(router, task, **table):
    host = Host.load()
    listed, rng = host.choose("router", router), np.random.default_rng(1)
    params = host.params(listed, table)
    return host.call(listed, task, params=params, rng=rng, stop=Stop(), progress=silent)


@pytest.mark.parametrize("size", ["A", "C", "D", "E"])
@pytest.mark.parametrize("name", ["ball", "two-balls"])
@pytest.mark.parametrize("router", ROUTERS)
def test_route(benchmark, router, name, size):
    task = support_scene(name, SIDES[size])
    plan = benchmark.pedantic(lambda: route(router, task), rounds=2, warmup_rounds=1)
    assert check_plan(task, plan) == []


@pytest.mark.parametrize("router", ["push-relabel", "min-cost-flow"])
@pytest.mark.parametrize("capacity", [1, 4])
def test_route_with_two_red_squares_that_cannot_be_connected(benchmark, router, capacity):
    task = support_scene("plate", SIDES["D"], capacity=capacity)
    plan = benchmark.pedantic(lambda: route(router, task), rounds=1, warmup_rounds=1)
    assert check_plan(task, plan) == []
    assert len(plan.unconnected) == 2


@pytest.mark.parametrize("name", ["ball", "two-balls"])
def test_rerouting_merges_paths_without_exceeding_nine_per_square(name):
    (result,) = run_scene(["shortest-paths"], name, "E", capacity=0, seed=0)
    assert present(result.squares_final) <= 0.45 * present(result.squares_initial)
    assert present(result.max_paths_per_square) <= 9
    assert result.peak_mb is None or result.peak_mb <= 1024


def test_routers_are_many_times_faster_than_or_tools_in_the_same_run():
    pytest.importorskip("ortools")
    results = run_scene(["push-relabel", "min-cost-flow"], "two-balls", "D", capacity=1, seed=0, rivals=True)
    times = {each.router: present(each.time_ratio) for each in results if each.validated}
    assert times["or-tools max-flow"] >= 10
    assert times["or-tools min-cost-flow"] >= 50


def test_voxelise_a_bumpy_ball_of_200000_triangles(benchmark):
    import manifold3d

    mesh = manifold3d.Manifold.sphere(40, 640).translate((50, 50, 50)).to_mesh()
    vertices, triangles = np.asarray(mesh.vert_properties[:, :3], float), np.asarray(mesh.tri_verts)
    block = Grid(np.zeros(3), 1.0, 1.0, (100, 100, 100)).block(vertices.min(axis=0), vertices.max(axis=0))

    def run():
        found = find_overhangs(vertices, triangles, angle_deg=45)
        return met_voxels(block, vertices, triangles), holding_voxels(block, vertices, triangles, found)

    black, _ = benchmark.pedantic(run, rounds=2, warmup_rounds=1)
    assert black.sum() == pytest.approx(4 / 3 * np.pi * 40**3, rel=0.08)
