"""A batch tells how all jobs ended, in their order, and its summary is always complete."""

import json
from pathlib import Path

import pytest
from tests.unit.batch.conftest import DONE, Plan

from amprep.batch.course import alone_in, run_batch
from amprep.batch.queue import LocalQueue
from amprep.errors import AmprepError, Interrupted
from amprep.files import held_alone


def read(folder: Path) -> dict[str, str]:
    return {each["name"]: each["state"] for each in json.loads((folder / "batch.json").read_text())["jobs"]}


def test_the_summary_has_every_job(plan: Plan, tmp_path: Path) -> None:
    jobs = plan({"b": ["import sys; sys.exit(2)"], "a": [DONE, "0"], "<c>": [DONE, "1"]})
    lines: list[str] = []
    shown: list[float] = []
    record = run_batch(
        jobs,
        LocalQueue(2, again=False),
        tmp_path / "out",
        progress=lambda fraction, _: shown.append(fraction),
        tell=lines.append,
    )
    assert [each.name for each in record.outcomes] == ["b", "a", "<c>"]
    assert record.counts == {"done": 1, "incomplete": 1, "refused": 1}
    assert record.faults == 2
    assert read(tmp_path / "out") == {"b": "refused", "a": "done", "<c>": "incomplete"}
    page = (tmp_path / "out" / "batch.html").read_text()
    assert '<a href="a/x.report.html">a</a>' in page
    assert "&lt;c&gt;</a>" in page
    assert "<c>" not in page
    assert len(lines) == 2
    assert any(line == "<c>: incomplete: 0 unplaced, 1 must be fixed" for line in lines)
    assert shown[-1] == 1.0


def test_a_signal_ends_the_batch_with_a_summary(plan: Plan, tmp_path: Path) -> None:
    jobs = plan({"a": [DONE, "0"], "b": ["import time; time.sleep(60)"], "c": [DONE, "0"]})

    def interrupt(fraction: float, _: str) -> None:
        if fraction > 0.0:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="1 of 3 jobs have ended"):
        run_batch(jobs, LocalQueue(1, again=False), tmp_path / "out", progress=interrupt, tell=lambda _: None)
    assert read(tmp_path / "out") == {"a": "done", "b": "not run", "c": "not run"}


def test_a_second_batch_into_the_same_folder_is_refused_while_the_first_runs(
    plan: Plan, tmp_path: Path
) -> None:
    jobs, out = plan({"a": [DONE, "0"]}), tmp_path / "out"
    with (
        alone_in(out),
        pytest.raises(AmprepError, match=r"another batch writes to .*out; wait until it has ended"),
    ):
        run_batch(jobs, LocalQueue(1, again=False), out, progress=lambda *_: None, tell=lambda _: None)
    assert not list(out.iterdir())
    run_batch(jobs, LocalQueue(1, again=False), out, progress=lambda *_: None, tell=lambda _: None)
    assert read(out) == {"a": "done"}
    assert not list(out.glob(".*"))


def test_the_lock_of_a_batch_that_was_killed_holds_no_other_off(tmp_path: Path) -> None:
    (tmp_path / ".amprep-batch").touch()
    with held_alone(tmp_path / ".amprep-batch") as is_alone:
        assert is_alone


def test_an_output_folder_below_a_file_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with (
        pytest.raises(AmprepError, match="cannot write to the output folder"),
        alone_in(tmp_path / "file" / "out"),
    ):
        pass
