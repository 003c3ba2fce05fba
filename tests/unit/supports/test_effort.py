"""Supports that cannot be finished in time are left out, and those that memory cannot hold are refused."""

import numpy as np
import pytest
from tests.shared.layouts import box, layout, placed

from amprep.errors import JobError
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.model.supports import OUT_OF_TIME
from amprep.model.supports.rules import SupportRules
from amprep.supports import effort
from amprep.supports.effort import Effort, effort_of, leave_out_late, require_memory

SMALL_AND_LARGE = placed(box((3, 3, 2), (5, 5, 8)), box((9, 9, 2), (30, 30, 20)))
EACH = Effort(seconds=1.0, megabytes=1.0)


def effort_of_cell(name):
    host = Host.load()
    cell = host.choose("cell", name)

    def emit(request):
        return host.call(cell, request, params=host.params(cell, {}), stop=Stop(), progress=silent)

    return effort_of(emit, 2.0, 2.0, SupportRules())


def test_a_cell_of_many_triangles_takes_more_than_a_prism():
    prism, x_wall = effort_of_cell("prism"), effort_of_cell("x-wall")
    assert 10 * prism.seconds < x_wall.seconds
    assert 10 * prism.megabytes < x_wall.megabytes


def test_without_a_deadline_and_with_enough_time_nothing_is_left_out():
    planned = layout(SMALL_AND_LARGE)
    assert leave_out_late(planned, EACH, Stop()) is planned
    assert leave_out_late(planned, EACH, Stop.after(len(planned.edges) + 10.0)) is planned


def test_the_largest_group_is_left_out_first_and_its_squares_are_out_of_time():
    planned = layout(SMALL_AND_LARGE)
    small, large = np.bincount(planned.edges.group).tolist()
    assert small < large
    reduced = leave_out_late(planned, EACH, Stop.after(small + 10.0))
    assert set(reduced.edges.group.tolist()) == {0}
    assert reduced.connected.tolist() == (planned.red.part == 0).tolist()
    assert {why for why, part in zip(reduced.reasons, planned.red.part, strict=True) if part == 1} == {
        OUT_OF_TIME
    }
    assert set(reduced.red_group[planned.red.part == 1].tolist()) == {-1}
    assert len(leave_out_late(planned, EACH, Stop.after(0.0)).edges) == 0


def test_supports_beyond_the_memory_are_refused_with_a_pitch_that_fits(monkeypatch):
    planned = layout(SMALL_AND_LARGE)
    monkeypatch.setattr(effort, "machine_megabytes", lambda: len(planned.edges) + 1.0)
    require_memory(planned, EACH)
    monkeypatch.setattr(effort, "machine_megabytes", lambda: len(planned.edges) / 8.0)
    with pytest.raises(JobError, match=r"pitch of 1 mm .*--set supports.pitch_mm=2\.?\d*"):
        require_memory(planned, EACH)
    assert effort.machine_megabytes() > 0.0
