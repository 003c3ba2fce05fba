"""Hashing finds the same first equal rows as sorting."""

import numpy as np
import pytest

from amprep.geometry.meshes import topology
from amprep.geometry.meshes.topology import first_of_equal_rows
from amprep.kernels.meshes import equal_rows
from amprep.kernels.meshes.equal_rows import first_of_equal


@pytest.mark.parametrize("kind", [np.float64, np.int64])
def test_hashing_and_sorting_find_the_same_rows(monkeypatch, kind):
    rng = np.random.default_rng(5)
    rows = rng.integers(-9, 9, (30_000, 3)).astype(kind)
    rows[rng.random(30_000) < 0.2, 1] *= -1  # zeros of both signs are equal
    hashed = first_of_equal_rows(rows)
    monkeypatch.setattr(topology, "_LEAST_HASHED", len(rows) + 1)
    assert (hashed == first_of_equal_rows(rows)).all()
    assert (rows[hashed] == rows).all()


def test_rows_are_sorted_where_the_kernel_gives_up(monkeypatch):
    monkeypatch.setattr(topology, "_LEAST_HASHED", 1)
    calls = []
    monkeypatch.setattr(equal_rows, "first_of_equal", lambda rows, first: calls.append(len(rows)))
    rows = np.array([[1.0, 2.0], [0.0, 1.0], [1.0, 2.0]])
    assert first_of_equal_rows(rows).tolist() == [0, 1, 0]
    assert calls == [3]


def test_equal_rows_need_one_probe_each():
    first = np.empty(3000, np.int64)
    assert first_of_equal(np.zeros((3000, 1), np.uint64), first)
    assert (first == 0).all()
