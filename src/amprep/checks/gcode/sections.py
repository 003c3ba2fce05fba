"""Horizontal sections of the solids of an object, and the printed layers beside them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Float32s, Floats, Int64s
from amprep.checks.gcode.found import SlicedLayer
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.plates.inward import is_wide
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_OUTLINE_STEP = 0.4
_LINE_STEP = 0.3
"""Distance (mm) of the points of outlines and of printed lines."""
_MOST_POINTS = 1_000_000
"""Most points of the outlines of a section; they are farther apart where there would be more."""
_THIN = 0.7
"""What is thinner than this fraction of the width of a line may be missing."""
_CLOSED = 0.05
"""Slicers close gaps of twice this width (mm), and print no walls there."""
_LEVEL, _SLIVER = 0.02, 0.2
"""Sections so far (mm) above and below each other must not differ by a region of at least this width (mm)."""


@dataclass(frozen=True, eq=False)
class ComparedLayer:
    """A printed layer, and the section of the object in the middle of it.

    Attributes
    ----------
    height
        Height of the section, mm.
    points
        ``(n, 2)`` mm, points of the printed lines in build coordinates.
    outer
        ``(n,)`` which of them are of outer walls.
    outline
        ``(k, 2)`` mm, points of the outlines of the section.
    required
        ``(m, 2)`` mm, points of the outlines, without what is too thin to be printed, and without narrow gaps.
    complete
        False if the lines of the layer are not all known.
    """

    height: float
    points: Floats
    outer: Bools
    outline: Floats
    required: Floats
    complete: bool


def compare_layers(
    bodies: Sequence[Mesh],
    layers: Sequence[SlicedLayer],
    origin: Floats,
    z_offset: float,
    thickest: float,
) -> list[ComparedLayer] | None:
    """Return printed layers with the sections of solids; None if a body is no solid.

    Parameters
    ----------
    bodies
        In build coordinates.
    layers
        Layers of the G-code.
    origin
        ``(2,)`` mm, where the corner of the build volume lies on the bed.
    z_offset
        What the slicer adds to all heights, mm.
    thickest
        Greatest thickness (mm) of layers: what lies below the first layer may be air.
    """
    solids = [as_manifold(each.vertices, each.triangles) for each in bodies]
    if not all(accepted(each) for each in solids):
        return None
    found = []
    for layer in layers:
        height = layer.z - z_offset - min(layer.thickness, thickest) / 2.0
        if _jumps(solids, height):
            continue
        section = _united([each.slice(height) for each in solids])
        width = 2.0 * float(np.median(layer.lines[:, 4])) if len(layer.lines) else 0.0
        thin = _THIN * width / 2.0
        points, line = line_points(layer.lines)
        found.append(
            ComparedLayer(
                height,
                points - origin,
                layer.lines[line, 5] > 0.0,
                _points_of(section),
                _points_of(section.offset(_CLOSED).offset(-_CLOSED - thin).offset(thin)),
                layer.complete,
            )
        )
    return found


def _jumps(solids: Sequence["Manifold"], height: float) -> bool:
    """Tell whether a level face is so near that the slicer may have cut above it as well as below it."""
    below, above = (_united([each.slice(height + side) for each in solids]) for side in (-_LEVEL, _LEVEL))
    return is_wide((above - below) + (below - above), _SLIVER)


def line_points(lines: Float32s) -> tuple[Floats, Int64s]:
    """Return points along lines ``(n, 6)``, both ends of each included, ``(k, 2)`` mm, and the line of each."""
    return _along(lines[:, :2].astype(np.float64), lines[:, 2:4].astype(np.float64), _LINE_STEP)


def _united(sections: Sequence["CrossSection"]) -> "CrossSection":
    from manifold3d import CrossSection, OpType

    return CrossSection.batch_boolean(list(sections), OpType.Add)


def _points_of(section: "CrossSection") -> Floats:
    """Return points along the outlines of a section, ``(n, 2)`` mm."""
    polygons = section.to_polygons()
    if not polygons:
        return np.empty((0, 2))
    starts = np.concatenate(polygons)
    ends = np.concatenate([np.roll(each, -1, axis=0) for each in polygons])
    length = float(np.linalg.norm(ends - starts, axis=1).sum())
    return _along(starts, ends, max(_OUTLINE_STEP, length / _MOST_POINTS))[0]


def _along(starts: Floats, ends: Floats, step: float) -> tuple[Floats, Int64s]:
    """Return points along straight lines at most a step apart, both ends included, and the line of each."""
    counts = np.ceil(np.linalg.norm(ends - starts, axis=1) / step).astype(np.int64) + 1
    counts = np.maximum(counts, 2)
    line = np.repeat(np.arange(len(starts)), counts)
    place = np.arange(len(line)) - np.repeat(np.cumsum(counts) - counts, counts)
    part = (place / (counts[line] - 1))[:, None]
    return starts[line] * (1.0 - part) + ends[line] * part, line
