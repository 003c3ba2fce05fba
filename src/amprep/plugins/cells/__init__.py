"""Built-in lattice cells: ``prism`` and ``x-wall``."""

from collections.abc import Iterator

from amprep.hookspecs import CellEmitter, hookimpl
from amprep.plugins.cells.prism import emit_prisms, prism_material
from amprep.plugins.cells.x_wall import XWallParams, emit_x_walls, x_wall_material

amprep_api = 1


@hookimpl
def amprep_cell_emitters() -> Iterator[CellEmitter]:
    """Yield the cells of thesis section 3.5."""
    yield CellEmitter("prism", "Every section as its full prism.", run=emit_prisms, material=prism_material)
    yield CellEmitter(
        "x-wall",
        "X-shaped walls whose arms meet their neighbours only every n-th layer, so that powder gets out.",
        run=emit_x_walls,
        params=XWallParams,
        material=x_wall_material,
    )
