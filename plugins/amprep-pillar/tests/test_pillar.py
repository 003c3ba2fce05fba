"""The pillar keeps the promises of a cell, has the estimated volume, and checks its diameter."""

import numpy as np
import pytest

from amprep.errors import JobError
from amprep.model import CellRequest, Grid, SupportEdges
from amprep.testing import load_offer, try_plugin

FRAME = Grid(np.array([10.0, 20, 0]), pitch=2.0, step=3.0, shape=(4, 4, 4))


def pillar(**params):
    return load_offer("cell", "pillar", plugin="amprep_pillar", params=params)


def emitted(cell, direction=(0, 1)):
    one = np.ones(len(direction))
    edges = SupportEdges(one, one, one, direction, flow=one, capacity=one, group=0 * one)
    return cell.run(CellRequest(FRAME, edges, role=0 * one))


def test_every_promise_holds_on_the_sample_problems():
    (report,) = try_plugin("amprep_pillar")
    assert (report.name, report.violations) == ("pillar", ())


def test_every_edge_becomes_one_pillar():
    cells = emitted(pillar())
    assert (len(cells.templates), cells.edge.tolist(), cells.template.tolist()) == (1, [0, 1], [0, 0])


def test_the_estimate_is_the_volume_of_the_pillar():
    # a regular octagon in a circle of radius r covers 2 sqrt(2) r^2
    cell = pillar(diameter_mm=1.0)
    volume = emitted(cell).templates[0].mesh.signed_volume * 2.0 * 2.0 * 3.0
    assert volume == pytest.approx(2 * np.sqrt(2) * 0.25 * 3.0)
    assert cell.material(2.0, 3.0) == pytest.approx((volume, volume))


def test_a_pillar_as_wide_as_the_pitch_is_allowed_and_a_wider_one_is_not():
    assert emitted(pillar(diameter_mm=2.0)).templates
    with pytest.raises(JobError, match=r"diameter_mm must be at most the pitch of 2 mm, got 2\.1"):
        emitted(pillar(diameter_mm=2.1))
    with pytest.raises(JobError, match="diameter_mm must be above 0, got 0"):
        pillar(diameter_mm=0)
