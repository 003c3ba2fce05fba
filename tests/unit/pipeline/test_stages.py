"""The clock adds up the durations of stages, and keeps them after an exception."""

import pytest

from amprep.pipeline import stages
from amprep.pipeline.stages import Clock, ProgressWatcher


@pytest.fixture
def ticking(monkeypatch):
    """Let each call of the clock be one second after the one before."""
    seconds = iter(range(100))
    monkeypatch.setattr(stages.time, "perf_counter", lambda: float(next(seconds)))


@pytest.mark.usefixtures("ticking")
def test_a_stage_that_is_entered_again_adds_to_its_duration_and_keeps_its_place():
    clock = Clock(ProgressWatcher())
    for name in ("read", "pack", "read"):
        with clock.stage(name):
            pass
    assert [(stage.name, stage.seconds) for stage in clock.times] == [("read", 2.0), ("pack", 1.0)]


@pytest.mark.usefixtures("ticking")
def test_a_stage_that_fails_is_timed_all_the_same():
    clock = Clock(ProgressWatcher())
    with pytest.raises(ZeroDivisionError), clock.stage("route"):
        _ = 1 / 0
    assert [(stage.name, stage.seconds) for stage in clock.times] == [("route", 1.0)]


def test_progress_is_passed_on_with_the_name_of_its_stage():
    calls = []
    clock = Clock(ProgressWatcher(lambda fraction, message: calls.append((fraction, message))))
    with clock.stage("pack") as progress:
        progress(0.5, "12 items")
    assert calls == [(0.5, "pack: 12 items")]
