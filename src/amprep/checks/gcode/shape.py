"""Judge the shape of printed layers: lines lie inside the sections of the solids, and outlines are printed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.gcode.sections import ComparedLayer
from amprep.geometry.meshes.containment import inside
from amprep.model.mesh import Mesh

OUTSIDE = 0.15
"""How far (mm) the middle of a line may lie outside of a section."""
_MISSED = 0.3
"""How far (mm) beyond the width of a line an outline may be from the next line."""
MOST_ASTRAY, MOST_MISSING = 0.02, 0.05
"""Greatest fraction of the lines that may be where none belongs, and of the outlines that may not be printed."""
_BETWEEN = 0.1
"""How much farther (mm) a line is from the next known point of an outline than from the outline."""
_FEW = 5
"""Layers with fewer points are not judged."""


@dataclass(frozen=True)
class ShapeFault:
    """The layer in which the shape is most wrong.

    Attributes
    ----------
    height
        mm.
    astray
        Fraction of its lines that are where none belongs.
    missing
        Fraction of the outlines of the section that are not printed.
    """

    height: float
    astray: float
    missing: float

    @property
    def words(self) -> str:
        """What is wrong, to follow the name of the object."""
        if self.astray > MOST_ASTRAY:
            what = f"{_percent(self.astray)} of its lines are where no wall was prepared"
        else:
            what = f"{_percent(self.missing)} of its outline is not printed"
        return f"at z = {self.height:.2f} mm, {what}"


def find_shape_fault(
    mesh: Mesh, layers: Sequence[ComparedLayer], width: float, shift: Floats
) -> ShapeFault | None:
    """Return the worst layer of an object, None if all are right.

    Parameters
    ----------
    mesh
        All solids of the object, in build coordinates.
    layers
        Some of its layers.
    width
        Width of lines, mm.
    shift
        ``(2,)`` mm by which the object is known to be moved.
    """
    judged = [layer for layer in layers if len(layer.points) >= _FEW or len(layer.required) >= _FEW]
    faults = [
        ShapeFault(
            layer.height,
            float(np.mean(astray_from(mesh, layer, width, shift))) if len(layer.points) else 0.0,
            missing_from(layer, layer.required + shift, width) if layer.complete else 0.0,
        )
        for layer in judged
    ]
    wrong = [each for each in faults if each.astray > MOST_ASTRAY or each.missing > MOST_MISSING]
    return max(wrong, key=lambda each: max(each.astray, each.missing), default=None)


def astray_from(mesh: Mesh, layer: ComparedLayer, width: float, shift: Floats) -> Bools:
    """Return which points of a layer lie outside of the solids, or as an outer wall far inside of them, ``(n,)``."""
    points = layer.points - shift
    distances = _distances(layer.outline, points)
    far: Bools = distances > OUTSIDE + _BETWEEN
    places = np.column_stack([points[far], np.full(int(far.sum()), layer.height)])
    deep = layer.outer[far] & (distances[far] > width + _MISSED)
    far[far] = deep | ~inside(places, mesh.vertices, mesh.triangles)
    return far


def missing_from(layer: ComparedLayer, outline: Floats, width: float) -> float:
    """Return the fraction of the points of an outline with no printed line beside them."""
    if not len(outline):
        return 0.0
    if not len(layer.points):
        return 1.0
    return float(np.mean(_distances(layer.points, outline) > width + _MISSED))


def _distances(of: Floats, points: Floats) -> Floats:
    """Return the distances (mm) of points from the nearest of others, infinite from 5 mm on, ``(n,)``."""
    from scipy.spatial import cKDTree

    if not len(of):
        return np.full(len(points), np.inf)
    return np.asarray(cKDTree(of).query(points, distance_upper_bound=5.0)[0])


def _percent(fraction: float) -> str:
    return f"{max(100.0 * fraction, 1.0):.0f} %"
