"""With interlocking forbidden, the parts of every packing can be taken out, whichever packer made it."""

import numpy as np
import pytest
from tests.shared.packers import PACKERS, accepted_by, packed_by
from tests.shared.removal import box
from tests.shared.solids import volume_of_solid

from amprep.checks.packing.removal import check_removal_order
from amprep.checks.packing.volumes_placed import PlacedVolume, check_packing
from amprep.geometry.removal.blocking import Blocking
from amprep.geometry.removal.order import DIRECTIONS, find_removal_order
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop
from amprep.repacking.interlocking import free_locked_items
from amprep.repacking.volume_bodies import VolumeBodies

CORNERS = (
    np.array([[0, 0, 0], [0, 0, 0], [0, 0, 8]], float),
    np.array([[8, 3, 2], [2, 3, 10], [8, 3, 10]], float),
)
"""A C of three boxes, open towards +x."""


def item_volume(accepts):
    """The richest volume of a C that a packer accepts."""
    if "solid" in accepts.volumes:
        solid = sum((box(lo, hi) for lo, hi in zip(*CORNERS, strict=True)), start=box((0, 0, 0), (1, 1, 1)))
        return volume_of_solid(solid)
    if "boxes" in accepts.volumes:
        return Boxes(*CORNERS)
    return Boxes(CORNERS[0].min(axis=0)[None], CORNERS[1].max(axis=0)[None])


def order_of(problem, build):
    volumes = VolumeBodies(problem)
    blocking = Blocking([volumes.body(placement) for placement in build], DIRECTIONS)
    return blocking, find_removal_order(blocking)


@pytest.mark.parametrize("packer", PACKERS)
def test_all_parts_can_be_taken_out(packer):
    accepts = accepted_by(packer)
    volume = item_volume(accepts)
    problem = PackingProblem(
        tuple(Item(0, copy, volume, 1.0) for copy in range(8)),
        BuildVolume(np.array([22.0, 12.0, 24.0])),
        "builds" if "builds" in accepts.objectives else "fill",
        clearance=0.5,
        stacking=True in accepts.stacking,
        interlocking="forbid",
    )
    freed = free_locked_items(problem, packed_by(packer, problem), Stop()).packing
    assert freed.builds
    assert check_packing(problem, freed) == []
    for build in freed.builds:
        blocking, order = order_of(problem, build)
        assert order.locked == ()
        if isinstance(volume, Boxes) and len(volume.lo) == 1:
            assert blocking.asked == 0, "boxes leave upwards, which is decided without meshes"
        solids = [PlacedVolume(problem, placement, fixed=False).solid for placement in build]
        assert check_removal_order(solids, [str(k) for k in range(len(solids))], order, 0.4) == []
