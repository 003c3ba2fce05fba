"""Kernels count as compiled when the cache has them."""

import sys
from pathlib import Path

import pytest

from amprep.cli.setup import kernels


def test_kernels_are_counted_by_the_files_in_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, cache = tmp_path / "kernels" / "sub", tmp_path / "cache"
    folder.mkdir(parents=True)
    cache.mkdir()
    source = "@njit(cache=True)\ndef one(): ...\n\n@kernel\ndef two(): ...\n\n@helper\ndef part(): ...\n"
    (folder / "some.py").write_text(source)
    monkeypatch.setattr(kernels, "_folder", lambda: tmp_path / "kernels")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    assert kernels.compiled_kernels().startswith("0 of 2;")
    tag = f"py{sys.version_info.major}{sys.version_info.minor}"
    (cache / f"some.one-2.{tag}.nbi").write_text("")
    (cache / f"some.part-8.{tag}.nbi").write_text("")
    (cache / "some.two-5.py27.nbi").write_text("")
    assert kernels.compiled_kernels().startswith("1 of 2;")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__" / f"some.two-5.{tag}1.nbi").write_text("")
    assert kernels.compiled_kernels().startswith("1 of 2;")
