"""Parts that hook into each other are named, and moved apart where the job forbids interlocking."""

import json

import pytest
from tests.shared.removal import hook_in_ring
from tests.shared.solids import mesh_of

from amprep.stl import write_stl

JOB = """
printer = "EOS P 396"
[packing]
strategy = "extreme-points"
clearance_mm = 0.5
[[part]]
file = "hook.stl"
fixed = [[11, 1, 1]]
[[part]]
file = "ring.stl"
fixed = [[1, 11, 11]]
"""


@pytest.fixture
def job(tmp_path):
    """Two linked rings at fixed positions, which no packer may change."""
    for name, solid in zip(("hook", "ring"), hook_in_ring(), strict=True):
        write_stl(mesh_of(solid), tmp_path / f"{name}.stl")
    path = tmp_path / "job.toml"
    path.write_text(JOB)
    return path


def test_locked_parts_are_named_and_are_a_fault_only_where_forbidden(amprep, job, tmp_path):
    allowed = amprep("run", job, "-o", tmp_path / "out")
    assert allowed.code == 0
    printed = " ".join(allowed.out.split()) + " ".join(allowed.err.split())
    assert "hook and ring are locked into each other" in printed
    (build,) = json.loads((tmp_path / "out" / "job.report.json").read_text(encoding="utf-8"))["builds"]
    assert build["removal_order"]["locked"] == [["hook", "ring"]]
    page = (tmp_path / "out" / "job.report.html").read_text(encoding="utf-8")
    assert "hook and ring are locked into each other" in page
    assert "locked with ring" in page
    forbidden = amprep("run", job, "--dry-run", "-o", tmp_path, "--set", "packing.interlocking=forbid")
    assert forbidden.code == 1
