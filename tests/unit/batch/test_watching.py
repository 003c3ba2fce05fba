"""Jobs that arrive in a folder run once, and only when their files are complete."""

from collections import deque
from pathlib import Path

import pytest

from amprep.batch import watching
from amprep.batch.records import BatchJob, JobOutcome
from amprep.batch.watching import FolderWatch, watch_folder


class InstantQueue:
    """A queue whose jobs are done at once."""

    def __init__(self) -> None:
        self._jobs: deque[BatchJob] = deque()
        self.ended = False

    def add(self, job: BatchJob) -> None:
        self._jobs.append(job)

    def outcomes(self, wait_s: float) -> list[JobOutcome]:  # noqa: ARG002 - the queue never waits
        found = [JobOutcome(job.name, job.source, job.folder, "done") for job in self._jobs]
        self._jobs.clear()
        return found

    @property
    def running(self) -> tuple[str, ...]:
        return ()

    @property
    def left(self) -> int:
        return len(self._jobs)

    def end(self) -> None:
        self.ended = True


def names(watch: FolderWatch, now: float) -> list[str]:
    return [job.name for job in watch.arrived(now)]


def test_a_job_begins_when_its_files_are_there_and_have_not_changed_for_a_while(tmp_path: Path) -> None:
    watch = FolderWatch(tmp_path, tmp_path / "out", ())
    assert names(watch, 0.0) == []
    (tmp_path / "a.toml").write_text('inputs = ["a.stl"]')
    assert names(watch, 1.0) == []
    assert names(watch, 9.0) == []  # the mesh is missing
    (tmp_path / "a.stl").write_text("half")
    assert names(watch, 10.0) == []
    (tmp_path / "a.stl").write_text("half a file")
    assert names(watch, 11.9) == []
    assert names(watch, 13.0) == []
    assert names(watch, 13.9) == ["a"]
    assert names(watch, 20.0) == []
    (tmp_path / "a.stl").write_text("another part")
    assert names(watch, 21.0) == []
    assert names(watch, 23.0) == ["a"]


def test_a_wrong_job_begins_so_that_its_error_is_shown(tmp_path: Path) -> None:
    watch = FolderWatch(tmp_path, tmp_path / "out", ())
    (tmp_path / "a.toml").write_text("inputs = 1")
    assert [names(watch, now) for now in (0.0, 2.0, 4.0)] == [[], ["a"], []]


def test_watching_ends_when_nothing_arrives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watching, "_BETWEEN_LOOKS_S", 0.01)
    (tmp_path / "a.3mf").write_text("")
    queue, lines = InstantQueue(), list[str]()
    watch = FolderWatch(tmp_path, tmp_path, (), settled_s=0.05)
    record = watch_folder(watch, queue, tmp_path, idle_s=0.5, tell=lines.append)
    assert [each.name for each in record.outcomes] == ["a"]
    assert lines == ["a: arrived", "a: done"]
    assert queue.ended
    assert (tmp_path / "batch.json").is_file()
