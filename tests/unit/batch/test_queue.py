"""Jobs run side by side in processes of their own, and one that fails costs no other."""

import sys
from pathlib import Path

import pytest
from tests.unit.batch.conftest import DONE, Plan

from amprep.batch import process
from amprep.batch.finished import FILE
from amprep.batch.queue import LocalQueue
from amprep.batch.records import JobOutcome

KILLED = "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"
REFUSED = "import sys; sys.stderr.write('note\\namprep: x.toml: \\x1b[31mwrong key\\n'); sys.exit(2)"
SILENT = "import sys; sys.exit(3)"
NO_REPORT = "print('finished')"


def run(jobs, count=2, *, again=False) -> dict[str, JobOutcome]:
    queue = LocalQueue(count, again=again)
    for job in jobs:
        queue.add(job)
    found: dict[str, JobOutcome] = {}
    while queue.left:
        assert len(queue.running) <= count
        found |= {each.name: each for each in queue.outcomes(0.5)}
    return found


def test_every_end_of_a_job_is_told_and_the_others_go_on(plan: Plan) -> None:
    found = run(
        plan(
            {
                "killed": [KILLED],
                "good": [DONE, "0"],
                "refused": [REFUSED],
                "silent": [SILENT],
                "short": [DONE, "2"],
                "mute": [NO_REPORT],
            }
        )
    )
    states = {name: each.state for name, each in found.items()}
    assert states == {
        "killed": "crashed",
        "good": "done",
        "refused": "refused",
        "silent": "crashed",
        "short": "incomplete",
        "mute": "crashed",
    }
    assert "SIGKILL" in found["killed"].message
    assert found["refused"].message == "x.toml:  [31mwrong key"
    assert "exit code 3" in found["silent"].message
    assert found["good"].figures == (1, 3, 0, 0, 4)
    assert found["short"].figures.must_fix == 2
    assert found["good"].files == ("x.build-1.3mf", "x.report.html")
    assert found["good"].page == "x.report.html"


def test_finished_jobs_are_not_run_again_and_all_others_are(plan: Plan, tmp_path: Path) -> None:
    jobs = plan({"a": [DONE, "0"], "b": [DONE, "1"], "c": [SILENT]})
    first = run(jobs)
    jobs = plan({"a": [KILLED], "b": [KILLED], "c": [DONE, "0"]})
    second = run(jobs)
    assert [second[name].earlier for name in "abc"] == [True, True, False]
    assert [second[name].state for name in "abc"] == ["done", "incomplete", "done"]
    assert second["a"].figures == first["a"].figures
    assert second["a"].files == first["a"].files
    (tmp_path / "out" / "a" / "x.build-1.3mf").unlink()
    third = run(jobs)
    assert [third[name].state for name in "abc"] == ["crashed", "incomplete", "done"]
    fourth = run(plan({"a": [DONE, "0"], "b": [DONE, "0"], "c": [DONE, "0"]}), again=True)
    assert not any(each.earlier for each in fourth.values())
    assert all((tmp_path / "out" / name / FILE).is_file() for name in "abc")


def test_a_job_whose_process_cannot_be_started_is_told(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = plan({"a": [DONE, "0"], "b": [DONE, "0"]})
    command = process.command_of
    missing = [str(jobs[0].folder / "no such program")]
    monkeypatch.setattr(
        process, "command_of", lambda job, count: missing if job.name == "a" else command(job, count)
    )
    found = run(jobs)
    assert [found[name].state for name in "ab"] == ["crashed", "done"]
    assert "cannot be started" in found["a"].message


def test_jobs_that_run_are_ended_and_the_others_do_not_begin(plan: Plan) -> None:
    waits = "import time; time.sleep(60)"
    queue = LocalQueue(1, again=False)
    for job in plan({"a": [waits], "b": [waits]}):
        queue.add(job)
    assert queue.outcomes(0.1) == []
    assert queue.running == ("a",)
    assert queue.left == 2
    queue.end()
    assert queue.left == 0
    assert queue.outcomes(0.0) == []


def test_the_process_of_a_job_runs_amprep_and_ends_with_the_batch(tmp_path: Path) -> None:
    from amprep.batch.process import command_of
    from amprep.batch.records import BatchJob

    command = command_of(BatchJob("a", tmp_path / "a.toml", tmp_path / "a", ("--set=seed=1",)), 3)
    assert command[:3] == [sys.executable, "-m", "amprep.cli.owned"]
    assert command[4:6] == ["run", str(tmp_path / "a.toml")]
    assert "--set=seed=1" in command
    assert command[command.index("--workers") + 1] == "3"
