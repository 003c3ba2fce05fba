"""Judge whether a cell can be printed and powder removed from it: steepness, thickness, escape of powder."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.violation import Violation
from amprep.geometry.cells.metrology import escape_diameter, smallest_feature
from amprep.geometry.cells.ports import flush_sides, snapped
from amprep.geometry.cells.struts import angles_deg
from amprep.model.cell_shapes import GraphCell
from amprep.model.cells import CellRequest, Cells, Template

STEEP, FEATURE, HOLE, POCKET = "steep enough", "smallest feature", "hole for powder", "no trapped powder"

BRIDGE = 0.6
"""Largest width (mm) of a downward face that needs no support, because it bridges between its neighbours."""


FINER = 2
"""Factor by which the voxels are finer on which the smallest feature is measured, in a part of the block."""


class PrintLimits(NamedTuple):
    """Limits of a machine.

    Attributes
    ----------
    angle_deg
        Smallest angle of struts and downward faces to the horizontal.
    feature
        Smallest thickness, mm.
    hole
        Smallest diameter of a hole through which powder escapes, mm.
    """

    angle_deg: float = 30.0
    feature: float = 0.15
    hole: float = 0.2


class CellMeasures(NamedTuple):
    """Measurements on a block of upright edges.

    Attributes
    ----------
    density
        Fraction of the volume of the block that is solid.
    feature
        Smallest feature, mm; at most a hundredth of the cell is thinner. None without solids.
    hole
        Diameter of the largest ball that escapes sideways from the void, mm. None without a void.
    pocket
        Fraction of the volume of the block that is void and closed on all sides.
    """

    density: float
    feature: float | None
    hole: float | None
    pocket: float


def check_struts(graph: GraphCell, linear: Floats, limits: PrintLimits, where: str) -> list[Violation]:
    """Judge the steepness of each strut and wall of a graph.

    Parameters
    ----------
    graph
        The cell.
    linear
        ``(3, 3)`` linear part of the map from the unit cube to mm.
    limits
        Limits to apply.
    where
        Name of the sample, for messages.
    """
    found = []
    for number, angle in enumerate(angles_deg(graph.points, graph.struts, linear).tolist()):
        if angle < limits.angle_deg - 1e-6 and not _is_short(graph.points[graph.struts[number]], linear):
            ends = graph.struts[number].tolist()
            message = (
                f"strut {number}, from point {ends[0]} to {ends[1]}, is at {angle:.1f} degrees on {where}"
            )
            found.append(Violation(STEEP, where, f"expected at least {limits.angle_deg:g}; {message}"))
    for number, face in enumerate(graph.faces):
        corners = graph.points[face] @ linear.T
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        angle = float(np.degrees(np.arccos(abs(normal[2]) / np.linalg.norm(normal))))
        if angle < limits.angle_deg - 1e-6:
            message = f"wall {number} is at {angle:.1f} degrees on {where}"
            found.append(Violation(STEEP, where, f"expected at least {limits.angle_deg:g}; {message}"))
    return found


def check_overhangs(template: Template, linear: Floats, limits: PrintLimits, where: str) -> list[Violation]:
    """Judge downward faces that are flatter than the limit, wider than a bridge and not on the cell below.

    Parameters
    ----------
    template, linear, limits, where
        As for `check_struts`.
    """
    points = snapped(template.mesh.vertices)
    triangles = template.mesh.triangles.astype(np.int64)
    corners = (points @ linear.T)[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    down = -normal[:, 2] / np.maximum(size, 1e-300)
    angle = np.degrees(np.arccos(np.clip(np.abs(down), 0.0, 1.0)))
    looking = (down > 0.0) if not template.surface else np.ones(len(triangles), np.bool_)
    flat = looking & (angle < limits.angle_deg - 1e-6) & (flush_sides(points, triangles) != 4) & (size > 1e-9)
    width = _width(corners, triangles, flat)
    if width <= BRIDGE:
        return []
    message = f"{template.name} has downward faces {width:.2g} mm wide at {angle[flat].min():.1f} degrees"
    return [Violation(STEEP, where, f"expected at least {limits.angle_deg:g}; {message} on {where}")]


def measure(request: CellRequest, cells: Cells, steps: int) -> CellMeasures:
    """Measure a block of upright edges.

    Parameters
    ----------
    request, cells
        The block, and the answer of the cell.
    steps
        Voxels along each edge of a cell; the smallest feature is measured on finer ones.
    """
    grid = request.grid
    size = np.array([grid.pitch, grid.pitch, grid.step])
    solids = [not template.surface for template in cells.templates]
    volume = np.array(
        [
            template.mesh.signed_volume if solid else 0.0
            for template, solid in zip(cells.templates, solids, strict=True)
        ]
    )
    density = float(volume[cells.template].sum()) / len(request.edges)
    if not any(solids):
        return CellMeasures(0.0, None, None, 0.0)
    place = request.edges.upper[cells.edge][:, ::-1]
    place = (place - place.min(axis=0)).astype(np.int64)
    meshes = [template.mesh.arrays for template in cells.templates]
    chosen = np.array(solids)[cells.template]
    template = cells.template.astype(np.int64)
    hole, pocket = escape_diameter(meshes, template[chosen], place[chosen], size, steps)
    few = chosen & (place < (2, 2, 3)).all(axis=1)
    thinnest = smallest_feature(meshes, template[few], place[few], size, FINER * steps)
    # a solid without any voxel centre is thinner than a voxel
    return CellMeasures(density, thinnest or 0.0, hole, pocket)


def check_measures(measures: CellMeasures, limits: PrintLimits, accuracy: float) -> list[Violation]:
    """Judge measurements on a block.

    Parameters
    ----------
    measures, limits
        Measurements, and limits to apply.
    accuracy
        Error (mm) of the hole; the error of the smallest feature is half of it.
    """
    found = []
    if measures.feature is not None and measures.feature + accuracy / FINER < limits.feature:
        message = f"expected at least {limits.feature:g} mm, measured {measures.feature:.2g} mm"
        found.append(Violation(FEATURE, "block", message))
    if measures.pocket > 0.0:
        message = f"{measures.pocket:.2%} of the block is void and closed on all sides, which traps powder"
        found.append(Violation(POCKET, "block", message))
    if measures.hole is not None and measures.hole + accuracy < limits.hole:
        message = f"expected escape channels of at least {limits.hole:g} mm, measured {measures.hole:.2g} mm"
        found.append(Violation(HOLE, "block", message))
    return found


def _is_short(ends: Floats, linear: Floats) -> bool:
    along = linear @ (ends[1] - ends[0])
    return bool(np.hypot(along[0], along[1]) <= BRIDGE)


def _width(corners: Floats, triangles: np.ndarray, chosen: Bools) -> float:
    """Return the width of the widest connected patch of the chosen triangles: area in plan divided by length."""
    from amprep.geometry.meshes.shells import label_shells

    if not chosen.any():
        return 0.0
    used, local = np.unique(triangles[chosen], return_inverse=True)
    count, label = label_shells(local.reshape(-1, 3), len(used))
    plan = corners[chosen][:, :, :2]
    one, other = plan[:, 1] - plan[:, 0], plan[:, 2] - plan[:, 0]
    area = np.bincount(label, np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2.0, count)
    least = np.full((count, 2), np.inf)
    most = np.full((count, 2), -np.inf)
    for corner in range(3):
        np.minimum.at(least, label, plan[:, corner])
        np.maximum.at(most, label, plan[:, corner])
    longest = np.hypot(*(most - least).T)
    return float((area / np.maximum(longest, 1e-9)).max())
