"""Lattice cells declared in files: each TOML and mesh file in this folder is a cell."""

from collections.abc import Iterator

from amprep.cells import cells_in
from amprep.hookspecs import CellEmitter, hookimpl

amprep_api = 1


@hookimpl
def amprep_cell_emitters() -> Iterator[CellEmitter]:
    """Yield the cells in this folder."""
    yield from cells_in(__file__)
