"""How long the stages of support planning take on the scenes of the references; seconds are printed only."""

import numpy as np
import pytest

from amprep.checks.supports import check_plan
from amprep.geometry.overhangs import find_overhangs
from amprep.geometry.voxels import Grid, holding_cubes, met_cubes
from amprep.model.control import Stop, silent
from amprep.model.supports import Cube, GridFrame, SupportProblem
from amprep.plugins.supports.params import ShortestPathsParams
from amprep.plugins.supports.shortest_paths import route_shortest_paths

SIZES = {"A": 20, "C": 40, "D": 104, "E": 186}
BALLS = {"ball": [(0.5, 0.5, 0.65, 0.28)], "two-balls": [(0.5, 0.5, 0.76, 0.20), (0.55, 0.5, 0.32, 0.18)]}


def scene(balls, side):
    """Balls ``(x, y, z, radius)`` in units of the cube; red under their faces flatter than 45 degrees."""
    cubes, needy = np.zeros((side,) * 3, np.uint8), np.zeros((side,) * 3, bool)
    for *centre, radius in balls:
        z, y, x = (np.indices(cubes.shape, np.float32) + 0.5) / side - np.reshape(centre[::-1], (3, 1, 1, 1))
        inside = z**2 + y**2 + x**2 <= radius**2
        cubes[inside] = Cube.BLACK
        needy |= inside & (z < 0) & (y**2 + x**2 <= 0.5 * radius**2)
    needy[0] = False
    needy[1:] &= cubes[:-1] == Cube.WHITE
    red = np.argwhere(needy)
    nothing = np.zeros(len(red), np.int32)
    frame = GridFrame(np.zeros(3), 1.0, 1.0, cubes.shape)
    return SupportProblem(frame, cubes, red, nothing, nothing, cubes[0] == Cube.WHITE)


@pytest.mark.parametrize("size", ["A", "C", "D", "E"])
@pytest.mark.parametrize("name", sorted(BALLS))
def test_shortest_paths(benchmark, name, size):
    task = scene(BALLS[name], SIZES[size])

    def run():
        rng = np.random.default_rng(1)
        return route_shortest_paths(task, params=ShortestPathsParams(), rng=rng, stop=Stop(), report=silent)

    plan = benchmark.pedantic(run, rounds=2, warmup_rounds=1)
    assert check_plan(task, plan) == []


def test_voxelise_a_bumpy_ball_of_200000_triangles(benchmark):
    import manifold3d

    mesh = manifold3d.Manifold.sphere(40, 640).translate((50, 50, 50)).to_mesh()
    vertices, triangles = np.asarray(mesh.vert_properties[:, :3], float), np.asarray(mesh.tri_verts)
    window = Grid(np.zeros(3), 1.0, 1.0, (100, 100, 100)).window(vertices.min(axis=0), vertices.max(axis=0))

    def run():
        found = find_overhangs(vertices, triangles, angle_deg=45)
        return met_cubes(window, vertices, triangles), holding_cubes(window, vertices, triangles, found)

    black, _ = benchmark.pedantic(run, rounds=2, warmup_rounds=1)
    assert black.sum() == pytest.approx(4 / 3 * np.pi * 40**3, rel=0.08)
