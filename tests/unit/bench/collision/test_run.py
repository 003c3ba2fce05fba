"""The benchmark of collision queries compares engines on the same poses, and notices wrong answers."""

import numpy as np
import pytest

from amprep.bench.collision import rivals
from amprep.bench.collision.engines import CollisionEngine
from amprep.bench.collision.rivals import CollisionRival
from amprep.bench.collision.run import run_collision
from amprep.bench.collision.scene import made_parts, near_contact


@pytest.fixture(scope="module")
def scene():
    return near_contact(made_parts(500), 30, margin=0.0, spread=0.5, seed=1)


def test_made_parts_have_about_as_many_triangles_as_asked_for():
    for mesh in made_parts(6000).values():
        assert 4000 < len(mesh.triangles) <= 6000


def test_some_poses_collide_and_some_do_not(scene):
    (result,) = [each for each in run_collision(scene, pieces=False, rivals=False) if each.query == "collide"]
    assert result.positive is not None
    assert 0 < result.positive < result.poses == 30
    assert result.validated


@pytest.mark.parametrize("margin", [0.0, 1.0])
def test_every_engine_agrees_with_the_trees(margin):
    scene = near_contact(made_parts(500), 15, margin=margin, spread=0.5, seed=1)
    results = [each for each in run_collision(scene, margin=margin) if each.microseconds is not None]
    assert {each.query for each in results} == {"collide", "distance", "directional"}
    assert {"OBB trees", "manifold3d"} <= {each.engine for each in results}
    assert all(each.validated for each in results if each.query != "directional")
    assert all(each.agree == each.of for each in results)


def test_an_engine_that_overlooks_collisions_is_found_wrong(scene, monkeypatch):
    def never(_scene, _margin):
        queries = {"collide": lambda poses, _: np.zeros(len(poses), bool)}
        return CollisionEngine("never", on_meshes=True, build_seconds=0.0, most_poses=9, queries=queries)

    monkeypatch.setattr("amprep.bench.collision.run.RIVALS", (CollisionRival("numpy", never),))
    result = list(run_collision(scene, pieces=False))[-1]
    assert (result.engine, result.poses, result.validated) == ("never", 9, False)


def test_a_package_that_is_not_installed_is_named(scene, monkeypatch):
    monkeypatch.setattr(
        "amprep.bench.collision.run.RIVALS", (CollisionRival("no_such_package", rivals.RIVALS[0].engine),)
    )
    assert "not installed" in list(run_collision(scene, pieces=False))[-1].line
