"""Fixed parts keep the positions that the job states; the others are packed around them."""

import json
import subprocess
import sys

JOB = """
printer = {{size_mm = [100, 100, 60]}}
inputs = ["{mesh}"]

[packing]
clearance_mm = 1
lift_mm = 0

[supports]
enabled = false

[[part]]
file = "{mesh}"
quantity = {quantity}
fixed = [[58, 58, 0]]
"""


def run(folder, fixtures, quantity):
    job = folder / "job.toml"
    job.write_text(JOB.format(mesh=(fixtures / "table.stl").as_posix(), quantity=quantity))
    command = [sys.executable, "-m", "amprep", "run", str(job), "-o", str(folder / "out"), "--json"]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)


def test_a_fixed_copy_keeps_its_position_and_the_others_keep_their_clearance(tmp_path, fixtures):
    done = run(tmp_path, fixtures, 3)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    (build,) = report["builds"]
    corners = [part["low_mm"] for part in build["parts"]]
    assert [58.0, 58.0, 0.0] in [[round(value, 3) for value in corner] for corner in corners]
    assert len(corners) == 3


def test_more_fixed_positions_than_copies_are_refused(tmp_path, fixtures):
    job = tmp_path / "job.toml"
    places = "[[0, 0, 0], [50, 50, 0]]"
    text = JOB.format(mesh=(fixtures / "table.stl").as_posix(), quantity=1)
    job.write_text(text.replace("[[58, 58, 0]]", places))
    command = [sys.executable, "-m", "amprep", "run", str(job), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 2
    assert "raise quantity" in done.stderr
