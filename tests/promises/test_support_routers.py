"""Every support router on offer keeps the promise of a plan, on generated scenes."""

import numpy as np
import pytest

from amprep.checks.supports.plan import check_plan
from amprep.geometry.voxels.grid import Grid
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.model.supports import SupportProblem, Voxel

HOST = Host.load()
ROUTERS = sorted(HOST.offers("router"))
SIDE = 16


def ball(voxels, needy, centre, radius):
    z, y, x = (np.indices(voxels.shape) + 0.5) / SIDE - np.reshape(centre[::-1], (3, 1, 1, 1))
    inside = z**2 + y**2 + x**2 <= radius**2
    voxels[inside] = Voxel.OCCUPIED
    needy |= inside & (z < 0) & (y**2 + x**2 <= 0.5 * radius**2)


def scene(name, **rules):
    """Scenes of the references: one ball, two balls above one another, a slab over a crowd of balls."""
    voxels, needy = np.zeros((SIDE,) * 3, np.uint8), np.zeros((SIDE,) * 3, bool)
    if name == "ball":
        ball(voxels, needy, (0.5, 0.5, 0.65), 0.28)
    elif name == "two-balls":
        ball(voxels, needy, (0.5, 0.5, 0.76), 0.20)
        ball(voxels, needy, (0.55, 0.5, 0.32), 0.18)
    else:
        rng = np.random.default_rng(3)
        for _ in range(10):
            ball(voxels, needy, (*rng.uniform(0.1, 0.9, 2), rng.uniform(0.15, 0.6)), rng.uniform(0.05, 0.1))
        voxels[13:15, 2:14, 2:14] = Voxel.OCCUPIED
        needy[13, 2:14, 2:14] = True
    needy[0] = False
    needy[1:] &= voxels[:-1] == Voxel.FREE
    red = np.argwhere(needy)
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    nothing = np.zeros(len(red), np.int32)
    return SupportProblem(grid, voxels, red, nothing, nothing, voxels[0] == Voxel.FREE, **rules)


@pytest.mark.parametrize("router", ROUTERS)
@pytest.mark.parametrize("name", ["ball", "two-balls", "plate"])
@pytest.mark.parametrize(
    "rules", [{}, {"edge_capacity": 2}, {"node_capacity": 3}, {"costs": (2, 3)}], ids=str
)
def test_a_plan_is_legal_conserved_and_complete(router, name, rules):
    listed = HOST.choose("router", router)
    task = scene(name, **rules)

    def route():
        rng = np.random.default_rng(7)
        return HOST.call(listed, task, params=HOST.params(listed, {}), rng=rng, stop=Stop(), progress=silent)

    plan, again = route(), route()
    assert check_plan(task, plan) == []
    for each in ("plane", "y", "x", "direction", "flow", "capacity"):
        assert getattr(plan.edges, each).tolist() == getattr(again.edges, each).tolist(), "two runs differ"
