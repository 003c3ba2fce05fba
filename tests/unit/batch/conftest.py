"""Batches whose jobs are small Python programs instead of ``amprep run``."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from amprep.batch import digest, process
from amprep.batch.records import BatchJob

DONE = """
import json, pathlib, sys
folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
(folder / "x.build-1.3mf").write_text("build")
(folder / "x.report.html").write_text("page")
build = {"file": "x.build-1.3mf", "picture": "", "stl_files": [], "parts": [1, 2, 3]}
triage = {"must_fix": int(sys.argv[2]), "worth_a_check": 4}
print(json.dumps({"job": "x", "builds": [build], "unplaced": [], "triage": triage}))
sys.exit(1 if triage["must_fix"] else 0)
"""
"""A job that writes a build; its second argument is the number of findings that must be fixed."""

Plan = Callable[[dict[str, Sequence[str]]], list[BatchJob]]


@pytest.fixture
def plan(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Plan:
    """Make jobs from a program and its further arguments for each name."""
    programs: dict[str, Sequence[str]] = {}

    def command(job: BatchJob, _workers: int) -> list[str]:
        program, *others = programs[job.name]
        return [sys.executable, "-c", program, str(job.folder), *others]

    monkeypatch.setattr(process, "command_of", command)
    monkeypatch.setattr(digest, "digest_of", lambda source, _: f"digest of {source.name}")

    def jobs(stated: dict[str, Sequence[str]]) -> list[BatchJob]:
        programs.update(stated)
        return [BatchJob(name, tmp_path / name, tmp_path / "out" / name) for name in stated]

    return jobs
