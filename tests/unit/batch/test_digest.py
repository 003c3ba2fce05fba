"""The digest of a job changes with everything that determines its result."""

from pathlib import Path

import pytest

from amprep.batch import digest
from amprep.batch.digest import digest_of, files_of, with_digest
from amprep.batch.records import BatchJob
from amprep.errors import AmprepError
from amprep.job import job_of


@pytest.fixture
def job(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "a.stl").write_text("a")
    (tmp_path / "cell.stl").write_text("cell")
    (tmp_path / "labels.csv").write_text("part,text\n")
    path = tmp_path / "job.toml"
    path.write_text('inputs = ["parts"]\nlabels = "labels.csv"\n[cells]\nstrategy = "cell.stl"\n')
    return path


def test_every_file_and_option_counts(job: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [digest_of(job, ())]
    assert with_digest(BatchJob("job", job, job.parent)).digest == found[0]
    for name in ("parts/a.stl", "cell.stl", "labels.csv"):
        (job.parent / name).write_text("changed")
        found.append(digest_of(job, ()))
    (job.parent / "parts" / "b.stl").write_text("b")
    found.append(digest_of(job, ()))
    found.append(digest_of(job, ("--set=seed=2",)))
    plugin = job.parent / "plugin.py"
    for text in ("one", "two"):
        plugin.write_text(text)
        found.append(digest_of(job, (f"--plugin={plugin}",)))
    job.write_text(f"seed = 3\n{job.read_text()}")
    found.append(digest_of(job, ()))
    monkeypatch.setattr(digest, "__version__", "another")
    found.append(digest_of(job, ()))
    assert "" not in found
    assert len(set(found)) == len(found)


def test_a_job_that_cannot_be_read_has_none(job: Path) -> None:
    (job.parent / "labels.csv").unlink()
    assert digest_of(job, ()) == ""
    assert digest_of(job.parent / "missing.toml", ()) == ""


def test_the_number_of_files_is_limited(job: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(digest, "MOST_FILES", 2)
    for number in range(4):
        (job.parent / "parts" / f"{number}.stl").write_text("")
    with pytest.raises(AmprepError, match="more than 2 files"):
        files_of(job_of([str(job)]))
    assert digest_of(job, ()) == ""
