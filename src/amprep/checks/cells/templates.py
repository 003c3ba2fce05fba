"""Judge the answer of a cell emitter: records that match the request, closed templates in the unit cube."""

import numpy as np

from amprep.checks.violation import Violation
from amprep.model.cells import CellRequest, Cells, Template
from amprep.model.mesh import Mesh

TOLERANCE = 1e-6
"""Largest distance by which a template may extend beyond the unit cube."""


def check_cells(request: CellRequest, cells: Cells) -> list[Violation]:
    """Judge the indices and maps of an answer, and each of its templates."""
    found = []
    numbers = {"edge": (cells.edge, len(request.edges)), "template": (cells.template, len(cells.templates))}
    for name, (values, count) in numbers.items():
        if ((values < 0) | (values >= count)).any():
            found.append(Violation("cell records", name, f"expected numbers from 0 to {count - 1}"))
    lengths = {len(cells.edge), len(cells.template), len(cells.matrix)}
    if len(lengths) > 1 or not np.isfinite(cells.matrix).all():
        found.append(Violation("cell records", "instances", "expected as many finite matrices as edges"))
    elif (np.linalg.det(cells.matrix[:, :, :3]) <= 0).any():
        found.append(Violation("cell records", "instances", "expected maps that do not mirror or flatten"))
    return found + [violation for template in cells.templates for violation in check_template(template)]


def check_template(template: Template) -> list[Violation]:
    """Judge one template: it must be in the unit cube and, unless it is a surface, closed with normals outwards."""
    mesh, name = template.mesh, template.name
    corners = len(mesh.vertices)
    if not len(mesh.triangles) or mesh.triangles.min() < 0 or mesh.triangles.max() >= corners:
        return [Violation("unit cube", name, f"expected triangles over its {corners} vertices")]
    found = []
    outside = max(-mesh.vertices.min(), mesh.vertices.max() - 1.0)
    if not outside <= TOLERANCE:  # also true for NaN
        found.append(Violation("unit cube", name, f"extends beyond the unit cube by {outside:.3g}"))
    if not template.surface and not _is_closed(mesh):
        found.append(
            Violation("closed", name, "a solid must have each edge equally often in both directions")
        )
    if not template.surface and not mesh.signed_volume > 0:
        found.append(Violation("closed", name, f"expected a positive volume, got {mesh.signed_volume:.3g}"))
    return found


def _is_closed(mesh: Mesh) -> bool:
    """Tell whether every directed edge occurs as often as its opposite."""
    edges = np.concatenate([mesh.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    forward = edges[np.lexsort(edges.T)]
    backward = edges[:, ::-1][np.lexsort(edges[:, ::-1].T)]
    return bool(len(edges)) and np.array_equal(forward, backward)
