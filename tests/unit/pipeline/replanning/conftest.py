"""A build that is edited and planned again."""

import pytest
from tests.shared.solids import mesh_of
from tests.shared.supported import box

import amprep
from amprep.stl import write_stl

JOB = """
printer = "EOS M290"
[packing]
strategy = "extreme-points"
clearance_mm = 4.0
lift_mm = 0.0
[supports]
rules = "thesis"
pitch_mm = 2.0
[cells]
strategy = "prism"
connector = "full"
[[part]]
file = "tee.stl"
quantity = 3
[[part]]
file = "bar.stl"
"""


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """A build of three tees with supports and a bar without."""
    folder = tmp_path_factory.mktemp("made")
    write_stl(mesh_of(box((4, 12, 10), (10, 0, 0)) + box((24, 12, 3), (0, 0, 9))), folder / "tee.stl")
    write_stl(mesh_of(box((12, 6, 5), (0, 0, 0))), folder / "bar.stl")
    (folder / "job.toml").write_text(JOB)
    record = amprep.run(folder / "job.toml", output=folder)
    assert record.faults == 0
    return folder


@pytest.fixture
def plate(made):
    return made / "job.build-1.3mf"
