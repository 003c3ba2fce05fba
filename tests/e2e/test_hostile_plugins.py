"""A plugin that ends the process, does not return or raises anything costs one line, and never passes for success."""

import os
import signal
import subprocess
import sys
import time

import pytest

PLUGIN = """
import ctypes, os, time
import numpy as np
from amprep.hookspecs import Packer, PackerAccepts, hookimpl
from amprep.model import Packing, Placement

amprep_api = 1
ANY = PackerAccepts(
    volumes=frozenset({"box", "boxes", "convex", "solid"}),
    orientations=frozenset({"fixed", "axis", "list", "about-z", "free"}),
)


def throw(error):
    raise error


def catch_everything():
    print("started", flush=True)
    while True:
        try:
            time.sleep(10)
        except BaseException:
            pass


def placed(count, **claims):
    return Packing((tuple(Placement(i, np.eye(3), np.zeros(3)) for i in range(count)),), **claims)


RUNS = {
    "leaves": lambda count: os._exit(0),
    "crashes": lambda count: ctypes.string_at(0),
    "interrupts": lambda count: throw(KeyboardInterrupt()),
    "stays": lambda count: catch_everything(),
    "boasts": lambda count: placed(count, bound=5.0),
}


@hookimpl
def amprep_packers():
    for name, run in RUNS.items():
        yield Packer(name, "Misbehaves.", accepts=ANY, run=lambda problem, run=run, **_: run(len(problem.items)))
"""


@pytest.fixture
def start(tmp_path, fixtures):
    """Return a function that starts `amprep run` with a packer of the plugin in a process of its own."""
    (tmp_path / "bad.py").write_text(PLUGIN)

    def start(packer, *options):
        command = ["run", f"{fixtures / 'ball.stl'}:2", "-o", tmp_path / "out", "-p", tmp_path / "bad.py"]
        command += ["--packer", packer, "--volumes", "box", "-q", *options]
        code = (
            "from amprep import supervision; supervision.GRACE_S = 1.0; from amprep.cli import main; main()"
        )
        return subprocess.Popen(
            [sys.executable, "-c", code, *map(str, command)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=dict(os.environ, AMPREP_LOAD_PLUGINS=""),
        )

    return start


@pytest.mark.parametrize(
    ("packer", "line"),
    [
        ("leaves", "packer 'leaves' of module bad ended the process; nothing was written"),
        (
            "crashes",
            "the process crashed (SIGSEGV) while packer 'crashes' of module bad ran; nothing was written",
        ),
        ("interrupts", "packer 'interrupts' of module bad failed: KeyboardInterrupt"),
        ("boasts", "packer 'boasts' of module bad broke its promise: packing reaches 1, which is better"),
    ],
)
def test_a_plugin_that_misbehaves_ends_the_run_with_one_line(start, tmp_path, packer, line):
    process = start(packer)
    _, said = process.communicate()
    assert process.returncode == 2
    assert said.startswith(f"amprep: {line}")
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_signal_ends_a_plugin_that_catches_everything(start, tmp_path):
    process = start("stays")
    assert process.stdout.readline() == "started\n"
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate()
    assert process.returncode == 143
    assert said == "amprep: interrupted while packer 'stays' of module bad ran; nothing was written\n"
    assert not (tmp_path / "out").exists()


def test_a_plugin_that_does_not_return_in_time_ends_the_run(start, tmp_path):
    began = time.monotonic()
    process = start("stays", "--time-limit", "0.2")
    _, said = process.communicate()
    assert process.returncode == 2
    assert said == (
        "amprep: packer 'stays' of module bad did not return within 1 s after its time limit; nothing was written\n"
    )
    assert time.monotonic() - began < 60
    assert not (tmp_path / "out").exists()
