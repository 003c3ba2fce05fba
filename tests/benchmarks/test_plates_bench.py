"""Packers on plates beside the 2D nesting package spyrrow, on the same shadows in the same run."""

import numpy as np
import pytest
import trimesh

from amprep.bench.plates.run import PlatesBench, PlatesScene, read_scene
from amprep.host import Host

SECONDS = 20.0


@pytest.fixture(scope="module")
def scene(tmp_path_factory) -> PlatesScene:
    """Return 40 brackets, rings and hulls of random sizes."""
    folder, rng = tmp_path_factory.mktemp("parts"), np.random.default_rng(3)
    for number in range(40):
        x, y = rng.uniform(15, 70, 2)
        kind = number % 3
        if kind == 0:
            corners = np.array([[0, 0], [x, 0], [x, 0.3 * y], [0.3 * x, 0.3 * y], [0.3 * x, y], [0, y]])
            mesh = trimesh.util.concatenate(
                [
                    trimesh.creation.box(bounds=[[0, 0, 0], [*corners[2], 5]]),
                    trimesh.creation.box(bounds=[[0, 0.3 * y, 0], [*corners[4], 5]]),
                ]
            )
            mesh = trimesh.boolean.union(mesh.split(), engine="manifold")
        elif kind == 1:
            mesh = trimesh.creation.annulus(0.3 * x, 0.5 * x, 5.0)
        else:
            mesh = trimesh.convex.convex_hull(rng.uniform(0, [x, y, 8], (12, 3)))
        mesh.export(folder / f"part-{number:02}.stl")
    return read_scene([folder], (160.0, 160.0), 2.0, "z90")


@pytest.mark.parametrize("packer", ["plates", "extreme-points"])
def test_packers_need_no_more_plates_than_the_nesting_package(scene, packer, record_property):
    pytest.importorskip("spyrrow")
    from amprep.bench.plates.rivals import spyrrow_plates

    if packer not in Host.load().offers("packer"):
        pytest.skip(f"there is no packer {packer}")
    bench = PlatesBench(scene, packer)
    bench.warm_up()
    ours, theirs = bench.run(1, SECONDS), spyrrow_plates(scene, seconds=SECONDS, seed=1)
    record_property("plates", ours.plates)
    record_property("ratio", ours.plates / theirs.plates)
    print(f"{packer} {ours.plates}, spyrrow {theirs.plates} plates, ratio {ours.plates / theirs.plates:.2f}")
    assert ours.validated, ours.faults
    assert theirs.validated, theirs.faults
    if packer == "plates":
        assert ours.plates <= theirs.plates
