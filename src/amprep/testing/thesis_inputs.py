"""Inputs A to E of the thesis's table of support planning (chapter 4), made anew at the same sizes.

The thesis shows its meshes but does not publish them. Of A and D only the sizes are known; B is two copies of A next to
each other, C two balls one above the other, and E a packing whose objects fill the printing volume.
"""

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.host import Host
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Placement, Stop, silent
from amprep.model.supports import SupportProblem, Voxel
from amprep.testing.support_scenes import problem_of_voxels, support_scene

INPUTS = ("A", "B", "C", "D", "E")

CUBES = {"A": ("ball", 20), "C": ("two-balls", 39), "D": ("plate", 103)}
"""Scene and voxels along each side of the inputs that are generated scenes."""

PACKED_SIDE, KINDS, COPIES = 186, 24, 12
"""Voxels along each side of input E; kinds of objects offered to it, and copies of each."""

APART = 10.0
"""Clearance and lift in input E (mm), so that four paths a square suffice for all red squares."""


def thesis_input(name: str, *, capacity: int = 0) -> SupportProblem:
    """Return the input ``A`` to ``E``, 1 mm a voxel, with as many nodes as the thesis's within 3 %.

    Parameters
    ----------
    name
        Letter of the input.
    capacity
        Largest number of paths through a square; 0 for no limit.
    """
    if name in CUBES:
        scene, side = CUBES[name]
        return support_scene(scene, side, capacity=capacity)
    voxels, overhanging = _two_of_a() if name == "B" else _packed_build()
    return problem_of_voxels(voxels, overhanging, capacity=capacity)


def _two_of_a() -> tuple[Bytes, Bools]:
    """Return the voxels and overhanging voxels of two copies of input A, 2 mm apart."""
    one = thesis_input("A")
    side = len(one.voxels)
    voxels = np.zeros((side, side + 10, 2 * side + 4), np.uint8)
    overhanging = np.zeros(voxels.shape, np.bool_)
    red = np.zeros(one.voxels.shape, np.bool_)
    red[tuple(one.red.T)] = True
    for x in (1, side + 3):
        place = np.s_[:, 5 : side + 5, x : x + side]
        voxels[place], overhanging[place] = one.voxels, red
    return voxels, overhanging


def _packed_build() -> tuple[Bytes, Bools]:
    """Return the voxels and overhanging voxels of balls and tables that `extreme-points` packs."""
    rng = np.random.default_rng(5)
    sizes = rng.integers(16, 50, (KINDS, 3))
    sizes[::2] = sizes[::2, :1]
    items = tuple(
        Item(part, copy, Boxes(np.zeros((1, 3)), size[None].astype(np.float64)), float(size.prod()))
        for part, size in enumerate(sizes)
        for copy in range(COPIES)
    )
    space = BuildVolume(np.full(3, float(PACKED_SIDE)))
    problem = PackingProblem(items, space, "fill", clearance=APART, lift=APART)
    voxels = np.zeros((PACKED_SIDE,) * 3, np.uint8)
    overhanging = np.zeros(voxels.shape, np.bool_)
    for placement in _packed(problem):
        x, y, z = np.rint(placement.translation).astype(int).tolist()
        a, b, c = sizes[items[placement.item].part].tolist()
        place = np.s_[z : z + c, y : y + b, x : x + a]
        solid, hangs = _ball(a) if items[placement.item].part % 2 == 0 else _table(a, b, c)
        voxels[place], overhanging[place] = np.where(solid, Voxel.OCCUPIED, Voxel.FREE), hangs
    return voxels, overhanging


def _packed(problem: PackingProblem) -> tuple[Placement, ...]:
    host = Host.load(plugins_enabled=False)
    packer = host.choose("packer", "extreme-points")
    rng, params = np.random.default_rng(0), host.params(packer, {"orderings": 1})
    return host.call(packer, problem, params=params, rng=rng, stop=Stop(), progress=silent).builds[0]


def _ball(side: int) -> tuple[Bools, Bools]:
    """Return the voxels of a ball, and those below which it is flatter than 45 degrees."""
    z, y, x = (np.indices((side,) * 3) + 0.5) / side - 0.5
    across = x**2 + y**2
    solid = z**2 + across <= 0.25
    return solid, solid & (z < 0.0) & (across <= 0.125)


def _table(x: int, y: int, z: int) -> tuple[Bools, Bools]:
    """Return the voxels of a plate on one leg, and the underside of the plate."""
    solid, hangs = np.zeros((z, y, x), np.bool_), np.zeros((z, y, x), np.bool_)
    plate = z - max(z // 4, 1)
    solid[plate:] = hangs[plate] = True
    leg = np.s_[y // 3 : y - y // 3, x // 3 : x - x // 3]
    solid[:plate, leg[0], leg[1]] = True
    hangs[plate, leg[0], leg[1]] = False
    hangs[0, leg[0], leg[1]] = True
    return solid, hangs
