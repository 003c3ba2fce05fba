"""``amprep bench merging`` measures and checks the union of random cells."""

from amprep.bench.memory import peak_mb, reset_peak
from amprep.bench.merging import run_merging


def test_the_union_of_random_cells_agrees_with_the_batch_union():
    result = run_merging(400, 150)
    assert result.validated
    assert result.junction_fraction > 0.15
    assert result.triangles == 200
    assert result.record["cells"] == 400
    assert "batch union" in result.line


def test_peak_memory_grows_with_an_allocation():
    reset_peak()
    before = peak_mb()
    block = bytearray(b"x") * (64 << 20)
    assert before is None or peak_mb() >= before + 32
    assert len(block) == 64 << 20
