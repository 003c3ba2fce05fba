"""The clock of a run measures its stages and passes their progress on."""

from contextlib import contextmanager

import pytest

from amprep.model import Stop
from amprep.pipeline.stages import Clock, ProgressWatcher, SupportStops


def test_a_stage_that_is_entered_again_adds_to_its_time_and_keeps_its_place():
    clock = Clock(ProgressWatcher())
    for name in ("read", "pack", "read"):
        with clock.stage(name):
            pass
    assert [stage.name for stage in clock.times] == ["read", "pack"]
    assert all(stage.seconds >= 0.0 for stage in clock.times)


def test_progress_is_passed_on_with_the_name_of_the_stage():
    heard = []
    clock = Clock(ProgressWatcher(lambda fraction, message: heard.append((fraction, message))))
    with clock.stage("pack") as progress:
        progress(0.5, "half")
    assert heard == [(0.5, "pack: half")]


def test_a_stage_that_fails_is_timed_and_left():
    left = []

    class Watcher:
        @contextmanager
        def stage(self, name):
            try:
                yield lambda *_: None
            finally:
                left.append(name)

    clock = Clock(Watcher())
    with pytest.raises(ValueError, match="no"), clock.stage("read"):
        raise ValueError("no")
    assert (left, [stage.name for stage in clock.times]) == (["read"], ["read"])


def test_supports_are_finished_as_long_after_the_time_limit_as_it_is_but_at_least_half_a_minute():
    for limit, later, last in ((1.0, 31.0, 61.0), (100.0, 200.0, 300.0)):
        stops = SupportStops.after(limit, Stop())
        assert stops.routing.remaining() == pytest.approx(limit, abs=1.0)
        assert stops.building.remaining() == pytest.approx(later, abs=1.0)
        assert stops.judging.remaining() == pytest.approx(last, abs=1.0)
    assert SupportStops.after(None, Stop()).building.deadline is None
