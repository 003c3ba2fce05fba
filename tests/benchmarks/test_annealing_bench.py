"""The packer `annealing` beside `extreme-points`: density of parts that fit into each other, in a low build."""

import time

import numpy as np
from manifold3d import Manifold

from amprep.checks.packing.volumes_placed import PlacedVolume, check_packing
from amprep.model import BuildVolume, Item, Mesh, Orientations, PackingProblem, Solid, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.annealing.pack import pack_annealing
from amprep.plugins.packers.annealing.params import AnnealingParams


def brackets(rng, count):
    """Return L-shaped, U-shaped and ring-shaped parts of random sizes as meshes."""
    for number in range(count):
        x, y, z = rng.uniform(10, 40, 3).round()
        block = Manifold.cube([x, y, z])
        kind = number % 3
        if kind == 0:
            solid = block - Manifold.cube([0.7 * x, y, 0.7 * z]).translate([0.3 * x, 0, 0.3 * z])
        elif kind == 1:
            solid = block - Manifold.cube([0.6 * x, y, 0.8 * z]).translate([0.2 * x, 0, 0.2 * z])
        else:
            solid = block - Manifold.cube([0.7 * x, 0.7 * y, z]).translate([0.15 * x, 0.15 * y, 0])
        mesh = solid.to_mesh64()
        yield Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def low_problem(count=20, seed=1):
    turns = Orientations("list", axis_rotations())
    items = tuple(
        Item(number, 0, Solid(mesh), mesh.signed_volume, turns)
        for number, mesh in enumerate(brackets(np.random.default_rng(seed), count))
    )
    return PackingProblem(items, BuildVolume(np.array([60.0, 60.0, 300.0])), "height", clearance=0.5)


def run(problem, moves, seconds=60.0):
    """Return height (mm), density, and processor time (s) of a packing; 0 moves give the start alone."""
    start = time.process_time()
    packing = pack_annealing(
        problem,
        params=AnnealingParams(moves=moves),
        rng=np.random.default_rng(1),
        stop=Stop.after(seconds),
        progress=silent,
    )
    spent = time.process_time() - start
    assert check_packing(problem, packing) == []
    tops = [PlacedVolume(problem, p, fixed=False).points[:, 2].max() for p in packing.builds[0]]
    height, volume = float(max(tops)), sum(item.volume.mesh.signed_volume for item in problem.items)
    return height, volume / (float(np.prod(problem.space.size[:2])) * height), spent


def test_annealing_is_at_least_as_dense_as_extreme_points_on_boxes(capsys):
    problem = low_problem()
    run(problem, 1)  # compiles
    rows = {name: run(problem, moves) for name, moves in (("extreme-points", 0), ("annealing", 2000))}
    with capsys.disabled():
        for name, (height, density, spent) in rows.items():
            print(f"\n{name:15} {height:7.1f} mm  {density:6.1%}  {spent:6.1f} s", end="")
    assert rows["annealing"][1] >= rows["extreme-points"][1]
