"""The bound for the parts themselves, whatever volumes the packer got."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.host import Host
from amprep.job import apply_sets, job_from_inputs
from amprep.model import Mesh, Part, Stop
from amprep.pipeline.packing import pack_parts, packing_stop
from amprep.pipeline.reading import LoadedParts
from amprep.pipeline.resolve import resolve
from amprep.pipeline.stages import Clock, ProgressWatcher


def wedge(side):
    """Half of a box."""
    corners = np.array(
        [[0, 0, 0], [side, 0, 0], [0, side, 0], [0, 0, 20], [side, 0, 20], [0, side, 20]], float
    )
    triangles = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
    return Mesh(corners, np.array(triangles))


def packed(*sets, mesh=None, quantity=2, **fields):
    mesh = mesh or wedge(200.0)
    part = Part("part", mesh, mesh.signed_volume, quantity=quantity, **fields)
    job = apply_sets(job_from_inputs(["part.stl"]), ["packing.strategy=extreme-points", *sets])
    loaded = LoadedParts(resolve(job, Host.load(plugins_enabled=False)), (part,))
    return pack_parts(loaded, Clock(ProgressWatcher()), Stop())


def test_boxes_need_two_builds_where_the_parts_might_share_one():
    found = packed()
    assert (len(found.builds), found.packing.bound, found.packing.bound_for) == (2, 2.0, "volumes")
    assert found.parts_bound == 1.0


def test_four_wedges_do_not_fit_one_plate():
    assert packed(quantity=4).parts_bound == 2.0


def test_the_bound_of_parts_that_are_boxes_is_that_of_the_packer():
    found = packed(mesh=box_mesh((0, 0, 0), (200, 200, 20)))
    assert (found.packing.bound_for, found.parts_bound) == ("shapes", found.packing.bound)


def test_surfaces_have_no_bound_of_their_own():
    assert packed(is_solid=False).parts_bound is None


@pytest.mark.parametrize(
    ("sets", "seconds"),
    [((), 50.0), (("supports.enabled=false",), 100.0), (("packing.time_limit_s=80",), 80.0)],
)
def test_packing_leaves_half_of_the_time_to_supports(sets, seconds):
    job = apply_sets(job_from_inputs(["part.stl"]), sets)
    assert packing_stop(Stop.after(100.0), job).remaining() == pytest.approx(seconds, abs=2.0)
