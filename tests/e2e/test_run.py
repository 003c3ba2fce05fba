"""`amprep run` from the command line: files, reports, verification, errors."""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest


def digest(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.3mf"))}


@pytest.fixture(scope="module")
def demo(tmp_path_factory, fixtures) -> Path:
    """Run the demo job once, in a new process."""
    folder: Path = tmp_path_factory.mktemp("demo")
    command = [
        sys.executable,
        "-m",
        "amprep",
        "run",
        str(fixtures / "demo" / "job.toml"),
        "-o",
        str(folder),
        "-q",
    ]
    assert subprocess.run(command, check=False).returncode == 0
    return folder


def test_the_demo_job_writes_build_files_reports_and_pictures_only(demo):
    names = sorted(path.name for path in demo.iterdir())
    assert names == [
        "job.build-1.3mf",
        "job.build-1.png",
        "job.placements.csv",
        "job.report.html",
        "job.report.json",
    ]


def test_the_report_contains_the_figures_of_the_demo_job(demo):
    report = json.loads((demo / "job.report.json").read_text(encoding="utf-8"))
    assert {"builds", "unplaced", "stages", "seed", "status", "stop_reason", "bound"} <= set(report)
    (build,) = report["builds"]
    assert {"file", "parts", "density", "height_mm", "supports"} <= set(build)
    assert len(build["parts"]) == 16, "sixteen copies of twelve parts"
    for part in build["parts"]:
        assert [len(row) for row in part["transform"]] == [4, 4, 4, 4]
        assert part["transform"][3] == [0, 0, 0, 1]
    assert build["supports"]["demand_squares"] > 0
    assert build["supports"]["volume_mm3"] > 0
    assert all(stage["seconds"] >= 0 for stage in report["stages"])


def test_a_written_build_is_verified_from_its_file_alone(demo, amprep):
    outcome = amprep("verify", demo / "job.build-1.3mf", "--json")
    assert outcome.json["violations"] == []
    assert outcome.code == 0


def test_the_same_job_and_seed_give_the_same_bytes(demo, amprep, fixtures, tmp_path):
    assert amprep("run", fixtures / "demo" / "job.toml", "-o", tmp_path, "-q").code == 0
    assert digest(tmp_path) == digest(demo)


def test_a_moved_part_fails_verification(demo, amprep, tmp_path):
    """Verification finds two parts that were moved into each other by editing the file."""
    import zipfile

    moved = tmp_path / "moved.3mf"
    with zipfile.ZipFile(demo / "job.build-1.3mf") as old, zipfile.ZipFile(moved, "w") as new:
        for name in old.namelist():
            text = old.read(name)
            if name == "3D/3dmodel.model":
                text = _with_first_transform_moved(text.decode()).encode()
            new.writestr(name, text)
    outcome = amprep("verify", moved, "--json")
    assert outcome.code == 1
    assert outcome.json["violations"]


def _with_first_transform_moved(text: str) -> str:
    import re

    match = re.search(r'transform="([^"]+)"', text)
    assert match
    numbers = match[1].split()
    numbers[9] = str(float(numbers[9]) + 40.0)
    return text[: match.start(1)] + " ".join(numbers) + text[match.end(1) :]


@pytest.mark.parametrize("target", ["generic", "prusaslicer", "cura"])
@pytest.mark.parametrize("cell", ["prism", "x-wall"])
def test_every_target_and_cell_verifies(amprep, fixtures, tmp_path, target, cell):
    small = ("--set", "supports.pitch_mm=2.5")
    command = ("run", fixtures / "table.stl", "-o", tmp_path, "--for", target, "--cell", cell, "--json")
    outcome = amprep(*command, *small)
    assert outcome.code == 0
    assert outcome.json["builds"][0]["supports"]["volume_mm3"] > 0
    assert amprep("verify", tmp_path / "table.build-1.3mf").code == 0


def test_walls_without_thickness_are_written_as_support_for_generic_readers_only(amprep, fixtures, tmp_path):
    thin = ["--cell", "x-wall", "--set", "cells.params.wall_mm=0", "--set", "cells.connector=extend"]
    outcome = amprep("run", fixtures / "table.stl", "-o", tmp_path, *thin, "--json")
    assert outcome.code == 0
    refused = amprep("run", fixtures / "table.stl", "-o", tmp_path, *thin, "--for", "cura")
    assert refused.code == 2
    assert "wall_mm" in refused.err


def test_files_folders_and_counts_may_be_mixed(amprep, fixtures, tmp_path):
    folder: Path = tmp_path / "parts"
    folder.mkdir()
    shutil.copy(fixtures / "ball.stl", folder)
    shutil.copy(fixtures / "table.stl", folder)
    outcome = amprep(
        "run",
        f"{folder}:2",
        f"{fixtures / 'knife-edge.stl'}:3",
        "--cell",
        "prism",
        "-o",
        tmp_path / "out",
        "--json",
        "--dry-run",
    )
    names = sorted(part["name"] for build in outcome.json["builds"] for part in build["parts"])
    assert names == ["ball", "ball-2", "knife-edge", "knife-edge-2", "knife-edge-3", "table", "table-2"]


def test_a_dry_run_writes_nothing(amprep, fixtures, tmp_path):
    outcome = amprep(
        "run", fixtures / "table.stl", "-o", tmp_path / "out", "--cell", "prism", "--dry-run", "--json"
    )
    assert outcome.code == 0
    assert outcome.json["builds"][0]["parts"]
    assert not (tmp_path / "out").exists()


def test_stl_files_are_in_build_coordinates(amprep, fixtures, tmp_path):
    import trimesh

    outcome = amprep(
        *("run", fixtures / "table.stl", "-o", tmp_path, "--cell", "prism"),
        *("--stl", "--json", "--set", "packing.lift_mm=3"),
    )
    names = outcome.json["builds"][0]["stl_files"]
    bounds = [trimesh.load_mesh(tmp_path / name).bounds for name in names]
    assert len(names) == 2, "the part and its supports"
    assert bounds[0][0][2] == pytest.approx(3.0, abs=1e-4)
    assert bounds[1][0][2] == pytest.approx(0.0, abs=1e-4)


def test_a_part_too_large_for_any_build_is_unplaced_and_the_rest_is_done(amprep, fixtures, tmp_path):
    small = ["--set", "printer={size_mm=[60.0,60.0,60.0]}", "--set", "packing.clearance_mm=0"]
    big = _box_stl(tmp_path / "big.stl", 80.0)
    outcome = amprep("run", big, fixtures / "knife-edge.stl", "-o", tmp_path, "--json", *small)
    assert outcome.code == 1
    assert [(entry["name"], entry["reason"]) for entry in outcome.json["unplaced"]] == [("big", "too large")]
    alone = amprep("run", big, "-o", tmp_path / "alone", *small)
    assert alone.code == 2
    assert not (tmp_path / "alone").exists()


def test_unplaced_parts_of_a_fill_job_are_not_faults(amprep, tmp_path):
    box = _box_stl(tmp_path / "box.stl", 40.0)
    outcome = amprep(
        "run", f"{box}:9", "-o", tmp_path / "out", "--json", "--set", "printer={size_mm=[100.0,100.0,50.0]}",
        "--cell", "prism",
        "--set", 'packing.objective="fill"',
    )  # fmt: skip
    assert outcome.code == 0
    assert len(outcome.json["builds"]) == 1
    assert len(outcome.json["builds"][0]["parts"]) == 4
    assert len(outcome.json["unplaced"]) == 5
    assert outcome.json["reached"] == pytest.approx(4 * 40.0**3)
    assert outcome.json["total_value"] == pytest.approx(9 * 40.0**3)
    assert [part["value"] for part in outcome.json["builds"][0]["parts"]] == pytest.approx([40.0**3] * 4)


def _box_stl(path: Path, side: float) -> Path:
    import trimesh

    trimesh.creation.box(extents=(side, side, side)).export(path)
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ["run"],
        ["run", "nothing-there.stl"],
        ["run", "table.stl", "--packer", "extreme-pionts"],
        ["run", "table.stl", "--set", "supports.pich_mm=1"],
        ["run", "table.stl", "--set", "cells.params.wal_mm=1"],
        ["run", "table.stl", "--printer", "EOS M29"],
        ["run", "table.stl", "--for", "bambu"],
        ["run", "table.stl", "-p", "no_such_module"],
        ["verify", "table.stl"],
        ["verify", "nothing-there.3mf"],
    ],
)
def test_a_user_error_gives_one_line_and_exit_code_2(amprep, fixtures, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    shutil.copy(fixtures / "table.stl", tmp_path)
    outcome = amprep(*arguments)
    assert outcome.code == 2
    assert "Traceback" not in outcome.err
    assert outcome.err.strip()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.stl"]


def test_every_malformed_fixture_is_refused_in_one_line(amprep, fixtures, tmp_path):
    for path in sorted((fixtures / "malformed").iterdir()):
        if path.name in ("inside-out.stl", "missing-thumbnail.3mf"):
            continue  # mended and reported instead
        outcome = amprep("run", path, "-o", tmp_path / "out")
        assert outcome.code == 2, path.name
        lines = [line for line in outcome.err.splitlines() if line.startswith("amprep:")]
        assert len(lines) == 1, (path.name, outcome.err)
        assert not (tmp_path / "out").exists(), path.name


def test_an_inside_out_mesh_is_reversed_with_a_note(amprep, fixtures, tmp_path):
    outcome = amprep("run", fixtures / "malformed" / "inside-out.stl", "-o", tmp_path, "--json")
    assert outcome.code == 0
    assert any("inside out" in note or "inside-out" in note for note in outcome.json["notes"])


@pytest.mark.parametrize("seconds", [0.3, 1.5, 3.0, 4.0])
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_writes_nothing(fixtures, tmp_path, seconds, how):
    command = [
        sys.executable,
        "-m",
        "amprep",
        "run",
        str(fixtures / "demo" / "job.toml"),
        "-o",
        str(tmp_path / "out"),
    ]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, "COLUMNS": "80"}
    )
    time.sleep(seconds)
    process.send_signal(how)
    _, err = process.communicate(timeout=60)
    if process.returncode == 0:
        return  # it had finished by then
    assert process.returncode in (128 + how, -how), err  # before Python can catch a signal, it dies
    left = list((tmp_path / "out").iterdir()) if (tmp_path / "out").exists() else []
    assert left == []
    assert b"Traceback" not in err
    if process.returncode == 128 + how:
        assert b"amprep: interrupted; nothing was written" in err


def test_help_takes_little_processor_time():
    """Processor time of the quickest of three: the wall clock would measure the neighbours' work too."""
    import resource

    seconds = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "amprep", "--help"], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    assert min(seconds) < 0.5
