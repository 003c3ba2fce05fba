"""The pillar: the promises on sample problems, its volume, and its own bounds."""

import numpy as np
import pytest

from amprep.errors import JobError
from amprep.host import Host
from amprep.model import CellRequest, Grid, Stop, SupportEdges, silent
from amprep.testing.conformance import try_plugin

FRAME = Grid(np.array([10.0, 20, 0]), pitch=2.0, step=3.0, shape=(4, 4, 4))


@pytest.fixture(scope="module")
def host():
    return Host.load(modules=["amprep_pillar"], env={"AMPREP_LOAD_PLUGINS": ""})


def emitted(host, table, direction=(0, 1)):
    count = len(direction)
    one = np.ones(count)
    edges = SupportEdges(one, one, one, direction, flow=one, capacity=one, group=0 * one)
    request = CellRequest(FRAME, edges, role=0 * one)
    listed = host.choose("cell", "pillar")
    return host.call(listed, request, params=host.params(listed, table), stop=Stop(), progress=silent)


def test_every_promise_holds_on_the_sample_problems():
    (trial,) = try_plugin("amprep_pillar")
    assert trial.name == "pillar"
    assert trial.violations == ()


def test_every_edge_becomes_one_pillar(host):
    cells = emitted(host, {})
    assert (len(cells.templates), cells.edge.tolist(), cells.template.tolist()) == (1, [0, 1], [0, 0])


def test_the_estimate_is_the_volume_of_the_pillar(host):
    # a regular octagon in a circle of radius r covers 2 sqrt(2) r^2
    listed = host.choose("cell", "pillar")
    params = host.params(listed, {"diameter_mm": 1.0})
    template = emitted(host, {"diameter_mm": 1.0}).templates[0].mesh
    volume = template.signed_volume * 2.0 * 2.0 * 3.0
    assert volume == pytest.approx(2 * np.sqrt(2) * 0.25 * 3.0)
    assert host.material(listed, 2.0, 3.0, params) == pytest.approx((volume, volume))


def test_a_pillar_as_wide_as_the_pitch_is_allowed_and_a_wider_one_is_not(host):
    assert emitted(host, {"diameter_mm": 2.0}).templates
    with pytest.raises(JobError, match=r"diameter_mm = 2\.1 is wider than the pitch, 2 mm"):
        emitted(host, {"diameter_mm": 2.1})
    with pytest.raises(JobError, match="diameter_mm is above 0, got 0"):
        emitted(host, {"diameter_mm": 0})
