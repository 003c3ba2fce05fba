"""Tell whether the walls of a lattice cell are thinner than the least wall, before supports are planned with it."""

from dataclasses import replace
from typing import TYPE_CHECKING

from amprep.cells.answers import Emit
from amprep.cells.samples import LAYERS, single_column
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model import Cells

if TYPE_CHECKING:
    from manifold3d import CrossSection

_KEPT = 0.7
"""Fraction of a section that discs of the least wall cover if its walls are thick enough; corners are left."""

_TOLERANCE = 0.03
"""Length (mm) by which walls may be thinner, because circles are polygons and walls have bends."""


def has_thin_walls(emit: Emit, pitch: float, step: float, least_wall: float) -> bool:
    """Tell whether most of each section of a lone column is thinner than the least wall.

    Walls without thickness, and cells that answer with finished meshes alone, are not judged.

    Parameters
    ----------
    emit
        Calls the cell.
    pitch, step
        Width and height (mm) of a voxel.
    least_wall
        Least thickness of a wall, mm.
    """
    request = replace(single_column(pitch, step, 0), beams=False, least_wall=least_wall)
    cells = emit(request)
    low = float(request.edges.plane.min() - 1) * step
    sections = [_section(cells, low + (layer + 0.5) * step) for layer in range(LAYERS)]
    found = [each for each in sections if each.area() > 0.0]
    radius = (least_wall - _TOLERANCE) / 2.0
    kept = (each.offset(-radius).offset(radius).area() / each.area() for each in found)
    return bool(found) and radius > 0.0 and all(fraction < _KEPT for fraction in kept)


def _section(cells: Cells, height: float) -> "CrossSection":
    """Return the horizontal section of all cells at a height, mm."""
    from manifold3d import CrossSection, OpType

    found = []
    for template, matrix in zip(cells.template, cells.matrix, strict=True):
        mesh = cells.templates[template].mesh
        solid = as_manifold(mesh.vertices @ matrix[:, :3].T + matrix[:, 3], mesh.triangles)
        if accepted(solid):
            found.append(solid.slice(height))
    return CrossSection.batch_boolean(found, OpType.Add) if found else CrossSection()
