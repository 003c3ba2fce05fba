"""Time of planning supports after a warm-up, on two cores: voxelise a full plate, and process a ball from mesh to file.

Run with ``pytest tests/benchmarks``.
"""

import time

import numpy as np
import trimesh

from amprep import api
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import met_voxels
from amprep.host import Host
from amprep.job import apply_sets, job_from_inputs


def test_45_meshes_of_5120_triangles_on_a_1_mm_grid_within_4_seconds():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=27.0)
    places = [(28 + 59 * (i % 8), 28 + 65 * (i // 8), 60.0) for i in range(45)]
    grid = Grid(np.zeros(3), 1.0, 1.0, (125, 440, 480))
    for _ in range(2):
        begun, met = time.perf_counter(), 0
        for place in places:
            vertices = ball.vertices * (1, 1, 2) + place
            block = grid.block(vertices.min(axis=0), vertices.max(axis=0))
            met += met_voxels(block, vertices, ball.faces).sum()
        seconds = time.perf_counter() - begun
    assert met > 45 * ball.volume * 2 * 0.99
    assert seconds < 4.0


def test_a_ball_of_56_mm_from_mesh_to_written_file_within_a_second(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=4, radius=28.0)
    ball.export(tmp_path / "ball.stl")
    sets = ["supports.pitch_mm=1", "cells.strategy=prism", "packing.lift_mm=5"]
    job, host = apply_sets(job_from_inputs([tmp_path / "ball.stl"]), sets), Host.load(plugins_enabled=False)
    for turn in range(3):
        record = api.run(job, output=tmp_path / str(turn), plugins=host)
    seconds = {stage.name: stage.seconds for stage in record.stages}
    assert (tmp_path / "2" / "ball.build-1.3mf").exists()
    assert sum(seconds[name] for name in ("read", "bound", "pack", "route", "cells", "judge", "write")) < 1.0
