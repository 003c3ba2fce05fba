"""Built-in lattice cells: ``prism``, ``x-wall``, ``strut``, ``bcc`` and ``hatch``."""

from collections.abc import Iterator

from amprep.cells import cell_offer
from amprep.hookspecs import CellEmitter, hookimpl
from amprep.plugins.cells.hatch import HatchParams, emit_hatch, hatch_material
from amprep.plugins.cells.prism import emit_prisms, prism_material
from amprep.plugins.cells.struts import (
    BccParams,
    StrutParams,
    declare_bcc,
    declare_strut,
    fit_bcc,
    fit_strut,
)
from amprep.plugins.cells.x_wall import XWallParams, emit_x_walls, x_wall_material

amprep_api = 1


@hookimpl
def amprep_cell_emitters() -> Iterator[CellEmitter]:
    """Yield the cells of thesis 3.5, two lattices of struts, and block supports."""
    yield CellEmitter("prism", "The whole prism of each edge.", run=emit_prisms, material=prism_material)
    yield CellEmitter(
        "x-wall",
        "X-shaped walls that meet their neighbours only in every n-th layer, so that powder escapes.",
        run=emit_x_walls,
        params=XWallParams,
        material=x_wall_material,
    )
    yield cell_offer(
        "strut",
        "A round pin along each edge, tied to its neighbours.",
        declare_strut,
        params=StrutParams,
        fit_params=fit_strut,
    )
    yield cell_offer(
        "bcc",
        "Round struts from the centre to the corners of the cell.",
        declare_bcc,
        params=BccParams,
        fit_params=fit_bcc,
    )
    yield CellEmitter(
        "hatch",
        "Block support: a grid of thin walls with perforations, teeth and gaps.",
        run=emit_hatch,
        params=HatchParams,
        material=hatch_material,
    )
