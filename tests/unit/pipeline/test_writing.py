"""The builds of a run are written, verified and drawn by several processes with the same bytes as by one."""

import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import amprep
from amprep import workers
from amprep.model import Stop
from amprep.model.volume_meshes import box_mesh
from amprep.pipeline import writing
from amprep.report import picture
from amprep.stl import write_stl

SETTINGS = {
    "printer": "Prusa MINI",
    "packing.strategy": "extreme-points",
    "packing.params": {"orderings": 1},
    "supports.enabled": False,
}


@pytest.fixture(autouse=True)
def small_pictures_and_small_work(monkeypatch):
    monkeypatch.setattr(picture, "write_picture", partial(picture.write_picture, size=(160, 120)))
    monkeypatch.setattr(workers, "_WORTH_IT", 0.0)


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """Write a block of which two do not fit beside each other."""
    write_stl(box_mesh(np.zeros(3), np.array((100.0, 100.0, 20.0))), tmp_path / "block.stl")
    return tmp_path / "block.stl"


def noted(forks, fork):
    forks.append("a process")
    return fork()


def run(part, folder, count):
    """Run three builds with so many processes; return their record, and the bytes of their files and pictures."""
    with workers.allowed(count):
        record = amprep.run(f"{part}:3", output=folder, stl=True, settings=SETTINGS)
    names = sorted(path.name for path in folder.iterdir() if path.suffix in {".3mf", ".png", ".stl"})
    return record, {name: (folder / name).read_bytes() for name in names}


def test_processes_change_no_byte_and_no_judgement(part, tmp_path, monkeypatch):
    forks: list[str] = []
    monkeypatch.setattr(os, "fork", partial(noted, forks, os.fork))
    alone, files = run(part, tmp_path / "alone", 1)
    assert not forks
    shared, same = run(part, tmp_path / "shared", 3)
    assert len(files) == 9  # a build file, a picture and an STL file of each build
    assert same == files
    assert len(forks) >= 3 + 2 + 2  # to write, to verify and to draw; one build is verified and drawn before
    for one, other in zip(alone.builds, shared.builds, strict=True):
        assert one.verification == other.verification == ()
        assert (one.file, one.sha256, one.picture, one.stl_files) == (
            other.file,
            other.sha256,
            other.picture,
            other.stl_files,
        )
        assert one.pairs == other.pairs


def test_builds_that_are_not_judged_in_time_count_as_broken(part, tmp_path):
    record, _ = run(part, tmp_path / "all", 1)
    builds = [each.build for each in record.builds]
    late = Stop.after(0.0)
    with workers.allowed(3):
        judged = writing._judged(builds, None, late, lambda *_: None)
    assert [each.ok for each in judged] == [False] * 3
