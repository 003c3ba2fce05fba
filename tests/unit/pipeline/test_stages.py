"""The clock of a run measures its stages and passes their progress on."""

from contextlib import contextmanager

import pytest

from amprep.pipeline.stages import Clock, ProgressWatcher


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
