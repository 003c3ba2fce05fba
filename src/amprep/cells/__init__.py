"""Declare lattice cells in Python or in files, and offer them to the host.

A complete lattice package::

    from amprep.cells import cell_offer
    from amprep.hookspecs import hookimpl
    from amprep.model import GraphCell

    amprep_api = 1

    @hookimpl
    def amprep_cell_emitters():
        pin = GraphCell(points=[[0.5, 0.5, 0], [0.5, 0.5, 1]], struts=[[0, 1]], radius=0.4)
        yield cell_offer("pin", "A round pin along each edge.", pin)
"""

from typing import TYPE_CHECKING, Any

from amprep.cells.files import CellFile, cells_in, read_cell
from amprep.cells.offers import GraphParams, cell_offer, estimate

if TYPE_CHECKING:
    from amprep.cells.emission import sides_taken

__all__ = ["CellFile", "GraphParams", "cell_offer", "cells_in", "estimate", "read_cell", "sides_taken"]


def __getattr__(name: str) -> Any:
    """Import `sides_taken` when it is first used: its module takes long to import."""
    if name != "sides_taken":
        raise AttributeError(f"module 'amprep.cells' has no attribute {name!r}")
    from amprep.cells.emission import sides_taken

    return sides_taken
