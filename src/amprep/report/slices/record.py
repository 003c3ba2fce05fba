"""The record of the slices of a build: files, and areas by layer."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from amprep.arrays import Floats

FORMS = ("cli", "cli-binary", "svg", "3mf-slice")
"""Formats of slices: Common Layer Interface as text or binary, SVG, and the 3MF Slice extension."""


@dataclass(frozen=True, eq=False)
class SlicedBodyRecord:
    """A sliced part or support.

    Attributes
    ----------
    area_mm2
        ``(layers,)`` area of its section in each layer.
    contours
        Number of contours in all layers.
    volume_mm3
        Volume of its mesh; 0 for walls without thickness.
    lines_mm
        Length of the lines of walls without thickness, in all layers.
    has_beams
        Whether it is a lattice of beams; the mesh that stands for the beams is sliced.
    """

    name: str
    role: Literal["part", "support"]
    area_mm2: Floats
    contours: int
    volume_mm3: float
    lines_mm: float = 0.0
    has_beams: bool = False


@dataclass(frozen=True, eq=False)
class SliceRecord:
    """The slices of a build.

    Attributes
    ----------
    build
        Name of the build.
    layer_mm, layers
        Thickness of a layer, and their number.
    bodies
        Parts, then supports.
    files
        Names of the files, in `folder`.
    """

    build: str
    layer_mm: float
    layers: int
    bodies: tuple[SlicedBodyRecord, ...]
    files: tuple[str, ...]
    folder: Path

    def area_mm2(self, role: str) -> Floats:
        """Return the area of all parts or all supports in each layer, ``(layers,)``."""
        areas = [each.area_mm2 for each in self.bodies if each.role == role]
        return np.asarray(np.sum([np.zeros(self.layers), *areas], axis=0))
