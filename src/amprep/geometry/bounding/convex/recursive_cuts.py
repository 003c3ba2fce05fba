"""Cut a solid by planes into cells that are nearly convex."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.cells import CutCell, cells_of, edges_of, hull_volume
from amprep.geometry.bounding.convex.cutting_planes import ConcaveFaces, candidate_planes, concave_faces

if TYPE_CHECKING:
    from manifold3d import Manifold

# Strategy. The cell whose hull has the greatest excess over the cell is cut next, by the plane after which the hulls
# of the connected components on both sides have the least total volume. Candidates are sections normal to the axes
# and the planes of faces at concave edges, which are the natural borders of the features of machine parts; the best
# candidate is then shifted by half, a quarter and an eighth of the distance between sections. A candidate is valued
# without cutting: vertices on one side are joined along edges, points where edges cross the plane are added, and the
# hulls are measured; this takes milliseconds for 20,000 triangles. Only the best plane cuts the solid. The union of
# the cells is the solid at every time.

SECTIONS_OF_LARGE, SECTIONS_OF_SMALL = 15, 5
"""Number of sections along each axis that are tried in a cell with a large excess, and in others."""

LARGE = 0.02
"""A large excess, as a fraction of the excess of the whole solid."""


def cut_into_cells(
    solid: "Manifold", most: int, excess: float, concavity: float, stop: Callable[[], bool]
) -> list[CutCell]:
    """Cut a solid into cells; their union is the solid with its cavities filled.

    Parameters
    ----------
    solid
        The solid.
    most
        Number of cells at which no further cut is made.
    excess
        Volume (mm3) of the total excess of the hulls at which no further cut is made.
    concavity
        Cells of which no vertex and no middle of an edge is deeper (mm) below the hull than this are not cut.
    stop
        Ends the search early.
    """
    todo: list[CutCell] = cells_of(solid)
    done: list[CutCell] = []
    if not todo:
        return []
    bounds = np.array(solid.bounding_box()).reshape(2, 3)
    size = float(np.linalg.norm(bounds[1] - bounds[0]))
    mesh = solid.to_mesh64()
    faces = concave_faces(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64))
    least = 1e-3 * excess
    first = sum(cell.excess for cell in todo)
    while todo and len(todo) + len(done) < most and not stop():
        todo.sort(key=lambda cell: -cell.excess)
        if sum(cell.excess for cell in todo) <= excess:
            break
        cell = todo.pop(0)
        parts = []
        if cell.excess > least and not _shallow(cell, concavity):
            sections = SECTIONS_OF_LARGE if cell.excess > LARGE * first else SECTIONS_OF_SMALL
            parts = _cut(cell, _best_plane(cell, faces, size, sections))
        if len(parts) > 1:
            todo += parts
        else:
            done.append(cell)
    return todo + done


def _shallow(cell: CutCell, concavity: float) -> bool:
    from amprep.geometry.bounding.convex.prepared import planes_of

    if concavity <= 0.0:
        return False
    planes = planes_of(cell.corners)
    middles = cell.vertices[edges_of(cell.triangles)].mean(axis=1)
    depth = (planes[:, 3] - np.concatenate((cell.vertices, middles)) @ planes[:, :3].T).min(axis=1)
    return bool(depth.max() <= concavity)


def _cut(cell: CutCell, plane: tuple[Floats, float]) -> list[CutCell]:
    normal, offset = plane
    above = cell.solid.trim_by_plane(normal.tolist(), offset)
    below = cell.solid.trim_by_plane((-normal).tolist(), -offset)
    return cells_of(below) + cells_of(above)


def _best_plane(cell: CutCell, faces: ConcaveFaces, size: float, sections: int) -> tuple[Floats, float]:
    """Return the candidate after which the hulls of the components have the least volume."""
    value = _Valuation(cell)
    best, chosen = np.inf, (np.eye(3)[0], 0.0)
    for normal, offset in candidate_planes(cell, faces, size, sections):
        total = value(normal, offset)
        if total < best * (1.0 - 1e-9):
            best, chosen = total, (normal, offset)
    normal, offset = chosen
    height = cell.corners @ normal
    step = float(height.max() - height.min()) / (sections + 1)
    for fraction in (0.5, 0.25, 0.125):
        for shifted in (offset - fraction * step, offset + fraction * step):
            if height.min() < shifted < height.max():
                total = value(normal, shifted)
                if total < best * (1.0 - 1e-9):
                    best, chosen = total, (normal, shifted)
        offset = chosen[1]
    return chosen


class _Valuation:
    """Total volume of the hulls of the components on both sides of a plane through a cell."""

    def __init__(self, cell: CutCell) -> None:
        self.vertices, self.edges = cell.vertices, edges_of(cell.triangles)
        self.label = np.empty(len(self.vertices), np.int64)
        self.section = np.empty((2 * len(self.edges), 3))
        self.owner = np.empty(2 * len(self.edges), np.int64)

    def __call__(self, normal: Floats, offset: float) -> float:
        from amprep.kernels.bounding.sides import label_sides

        height = self.vertices @ normal - offset
        count = label_sides(self.vertices, self.edges, height, self.label, self.section, self.owner)
        label = np.concatenate((self.label, self.owner[:count]))
        order = np.argsort(label, kind="stable")
        points = np.concatenate((self.vertices, self.section[:count]))[order]
        borders = np.flatnonzero(np.diff(label[order])) + 1
        return sum(hull_volume(group) for group in np.split(points, borders))
