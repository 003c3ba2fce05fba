"""The cell ``prism``: each edge becomes its whole prism (thesis 3.5)."""

import numpy as np

from amprep.hookspecs import NoParams
from amprep.model import CellRequest, Cells, Mesh, Progress, Stop, Template

_CORNERS = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
# opposite faces are cut along the same diagonal, so that adjacent prisms have the same triangles
_FACES = [
    [0, 2, 3], [0, 3, 1], [4, 7, 6], [4, 5, 7],
    [0, 1, 5], [0, 5, 4], [2, 7, 3], [2, 6, 7],
    [0, 4, 6], [0, 6, 2], [1, 7, 5], [1, 3, 7],
]  # fmt: skip


def unit_cube() -> Mesh:
    """Return the unit cube as twelve triangles; opposite faces are cut along the same diagonal."""
    return Mesh(np.array(_CORNERS, np.float64), np.array(_FACES, np.int32))


def emit_prisms(request: CellRequest, *, params: NoParams, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
    """Put the unit cube under the map of each edge."""
    count = len(request.edges)
    templates = (Template("prism", unit_cube()),)
    return Cells(templates, np.zeros(count, np.int32), np.arange(count, dtype=np.int32), request.matrices)


def prism_material(pitch: float, step: float, params: NoParams) -> tuple[float, float]:  # noqa: ARG001
    """Return the volume (mm3) of an upright and of an oblique prism; shear preserves volume."""
    return pitch * pitch * step, pitch * pitch * step
