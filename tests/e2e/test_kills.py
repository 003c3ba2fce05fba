"""A signal at each step of a job leaves all of its files or none, and the next run finds a clean folder."""

import os
import signal
import subprocess
import sys

import pytest

from amprep.pipeline.outputs import OutputFolder

STEPS = ("folder made", "file written", "first file moved", "files moved")
"""Moments of a run at which it sends itself a signal."""

JOB = """
import os, signal, sys
from pathlib import Path
import amprep.cli.app
from amprep import cli
from amprep.pipeline.outputs import OutputFolder

folder, number, step = sys.argv[1], int(sys.argv[2]), sys.argv[3]
sys.argv = ["amprep"]

def at(reached):
    if reached == step:
        os.kill(os.getpid(), number)

replace = Path.replace

def replace_and_signal(path, target):
    moved = replace(path, target)
    at("first file moved")
    return moved

def app():
    with OutputFolder(Path(folder), "job") as outputs:
        at("folder made")
        for name in ("a", "b", "c"):
            outputs.path(name).write_text("new")
            at("file written")
        Path.replace = replace_and_signal
        outputs.publish()
        at("files moved")

amprep.cli.app.app = app
cli.main()
"""


def run(folder, number, step):
    """Run a small job that sends itself a signal at a step; return the ended process."""
    return subprocess.run(
        [sys.executable, "-c", JOB, str(folder), str(int(number)), step],
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ),
    )


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_all_files_or_none_and_the_code_tells_which(tmp_path, number, step):
    ended = run(tmp_path / "out", number, step)
    if step in ("folder made", "file written"):
        assert ended.returncode == 128 + number
        assert ended.stderr == "amprep: interrupted; nothing was written\n"
        assert not (tmp_path / "out").exists()
    else:
        assert ended.returncode == 0
        assert (
            ended.stderr == f"amprep: {number.name} came when the files appeared; all of them are complete\n"
        )
        assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["job.a", "job.b", "job.c"]


@pytest.mark.parametrize("step", STEPS)
def test_after_sigkill_no_file_is_half_and_the_next_run_leaves_a_clean_folder(tmp_path, step):
    assert run(tmp_path, signal.SIGKILL, step).returncode == -signal.SIGKILL
    assert {path.read_text(encoding="utf-8") for path in tmp_path.glob("job.*")} <= {"new"}
    assert len(list(tmp_path.glob(".amprep-*"))) == 1
    with OutputFolder(tmp_path, "job") as outputs:
        outputs.path("a").write_text("newer")
        outputs.publish()
    assert list(tmp_path.glob(".*")) == []
    assert (tmp_path / "job.a").read_text(encoding="utf-8") == "newer"


def test_two_runs_into_one_folder_do_not_mix_their_files(tmp_path):
    """Each of two processes publishes its own pair again and again; a third one never sees a mixed pair."""
    code = (
        "import sys; from pathlib import Path; from amprep.pipeline.outputs import OutputFolder\n"
        "for _ in range(20):\n"
        "    with OutputFolder(Path(sys.argv[1]), 'job') as outputs:\n"
        "        for name in ('a', 'b'): outputs.path(name).write_text(sys.argv[2])\n"
        "        outputs.publish()\n"
    )
    runs = [subprocess.Popen([sys.executable, "-c", code, str(tmp_path), text]) for text in ("one", "two")]
    assert [each.wait() for each in runs] == [0, 0]
    assert (tmp_path / "job.a").read_text(encoding="utf-8") == (tmp_path / "job.b").read_text(
        encoding="utf-8"
    )
    assert sorted(path.name for path in tmp_path.iterdir()) == ["job.a", "job.b"]
