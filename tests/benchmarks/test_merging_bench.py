"""Time to unite cells to one mesh, compared with manifold3d's batch union in the same run."""

import pytest

from amprep.bench.merging import run_merging


@pytest.mark.parametrize("cells", [4_096, 100_000])
def test_merging_cells_of_200_triangles(benchmark, cells):
    result = benchmark.pedantic(lambda: run_merging(cells, 4096), rounds=1)
    benchmark.extra_info.update(result.record)
    assert result.validated
    if cells == 100_000:
        assert result.junction_fraction >= 0.2
        assert result.seconds <= 15.0
        assert result.peak_mb is None or result.peak_mb <= 6 * 1024
    assert result.time_ratio >= (50 if cells == 100_000 else 10)
