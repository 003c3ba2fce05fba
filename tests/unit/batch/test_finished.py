"""A note in the folder of a job says that it is finished; nothing else counts as one."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from amprep.batch.finished import FILE, finished_before, json_object, note_finished
from amprep.batch.records import BatchJob, JobFigures, JobOutcome


@pytest.fixture
def job(tmp_path: Path) -> BatchJob:
    (tmp_path / "a.3mf").write_text("build")
    return BatchJob("a", tmp_path / "a.toml", tmp_path, (), "digest")


def outcome(job: BatchJob) -> JobOutcome:
    return JobOutcome(job.name, job.source, job.folder, "done", "", JobFigures(1, 2), ("a.3mf",), 3.5)


def test_a_finished_job_is_known_until_something_changes(job: BatchJob) -> None:
    assert finished_before(job) is None
    note_finished(job, outcome(job))
    assert finished_before(job) == replace(outcome(job), earlier=True)
    assert finished_before(replace(job, digest="other")) is None
    assert finished_before(replace(job, digest="")) is None
    (job.folder / "a.3mf").write_text("another build")
    assert finished_before(job) is None


def test_only_jobs_with_complete_files_are_noted(job: BatchJob) -> None:
    note_finished(job, replace(outcome(job), state="crashed"))
    note_finished(replace(job, digest=""), outcome(job))
    assert not (job.folder / FILE).exists()


@pytest.mark.parametrize(
    "change",
    [
        {"files": {"../a.3mf": 5}},
        {"files": ["a.3mf"]},
        {"files": {"a.3mf": "many"}},
        {"figures": {"unknown": 1}},
        {"format": 2},
        {"seconds": None},
        {"digest": None},
    ],
)
def test_a_note_that_is_wrong_counts_as_none(job: BatchJob, change: dict[str, object]) -> None:
    note_finished(job, outcome(job))
    path = job.folder / FILE
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    assert finished_before(job) is None


@pytest.mark.parametrize("text", ["", "[]", "{", "1", "[" * 10_000])
def test_a_text_that_is_no_object_gives_an_empty_one(job: BatchJob, text: str) -> None:
    assert json_object(text) == {}
    (job.folder / FILE).write_text(text)
    assert finished_before(job) is None
