"""``amprep bench merging`` measures and checks the union of random cells."""

import subprocess
import sys

from amprep.bench.merging import run_merging


def test_the_union_of_random_cells_agrees_with_the_batch_union():
    result = run_merging(400, 150)
    assert result.validated
    assert result.junction_fraction > 0.15
    assert result.triangles == 200
    assert result.record["cells"] == 400
    assert "batch union" in result.line


GROWTH = """
from amprep.bench.memory import peak_mb
before = peak_mb()
block = bytearray(b"x") * (256 << 20)
print(-1 if before is None else peak_mb() - before)
"""


def test_peak_memory_grows_with_an_allocation():
    # a process of its own: memory that a test before this one has used would hide the growth
    grown = int(subprocess.run([sys.executable, "-c", GROWTH], capture_output=True, check=True).stdout)
    assert grown == -1 or grown >= 200
