"""Support problems on grids small enough to know the answer, and random ones; routers called as the host calls them."""

import numpy as np

from amprep.geometry.voxels.grid import Grid
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.model.supports import SupportProblem, Voxel

HOST = Host.load()

COSTS, ODD_COSTS = [(1, 2), (0, 1), (3, 4), (1, 7)], [(1, 0), (0, 0), (5, 0), (7, 1)]


def problem(voxels, red, **rules):
    """A problem on a grid of 1 mm, of a single part."""
    voxels = np.asarray(voxels, np.uint8)
    red = np.array(red, np.int32).reshape(-1, 3)
    nothing = np.zeros(len(red), np.int32)
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    return SupportProblem(grid, voxels, red, nothing, nothing, voxels[0] == Voxel.FREE, **rules)


def hanging(shape, squares, **rules):
    """An empty grid of `shape` voxels whose top layer is black over the given ``(y, x)`` squares."""
    voxels = np.zeros(shape, np.uint8)
    top = shape[0] - 1
    for y, x in squares:
        voxels[top, y, x] = Voxel.OCCUPIED
    return problem(voxels, [(top, y, x) for y, x in squares], **rules)


def floor_with_holes(holes, **rules):
    """Seven red squares in a row, high above a floor with holes at the given x."""
    voxels = np.zeros((12, 3, 7), np.uint8)
    voxels[11, 1] = voxels[1] = Voxel.OCCUPIED
    voxels[1, 1, list(holes)] = Voxel.FREE
    return problem(voxels, [(11, 1, x) for x in range(7)], **rules)


def random_problem(seed, **rules):
    """Small random grids, capacities and costs; in a third of them paths can pass through red squares."""
    rng = np.random.default_rng(seed)
    voxels = (rng.random(tuple(rng.integers(3, 7, 3))) < rng.uniform(0.1, 0.5)).astype(np.uint8)
    if rng.random() < 0.3:
        red = [at for at in np.add(np.argwhere(voxels[:-1] == Voxel.FREE), (1, 0, 0)) if rng.random() < 0.5]
    else:
        red = [(p, y, x) for p, y, x in np.argwhere(voxels) if p > 0 and not voxels[p - 1, y, x]]
    edge, node = (int(each) for each in rng.integers(0, 4, 2))
    costs = COSTS[rng.integers(4)]
    if rng.random() < 0.3:
        costs = ODD_COSTS[rng.integers(4)]
    return problem(voxels, red, **{"edge_capacity": edge, "node_capacity": node, "costs": costs} | rules)


class Late(Stop):
    """Says stop from a number of questions on; `asked` counts them."""

    number: int
    asked: int

    def __init__(self, number):
        super().__init__()
        self.__dict__.update(number=number, asked=0)

    def __call__(self):
        self.__dict__["asked"] += 1
        return self.asked > self.number

    def within(self, seconds):  # noqa: ARG002
        return self

    @property
    def reason(self):
        return "time limit"


def route(router, task, stop=None, **params):
    """Route by the router of a name."""
    listed = HOST.choose("router", router)
    rng = np.random.default_rng(0)
    return HOST.call(
        listed, task, params=HOST.params(listed, params), rng=rng, stop=stop or Stop(), progress=silent
    )
