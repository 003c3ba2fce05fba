"""Measure how the cross-section of a build changes with height."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.geometry.slicing.cross_sections import cross_section_areas
from amprep.model import Build

MOST_SAMPLES = 200
"""Heights at which the cross-section is measured."""

LEAST_SPACING = 0.1
"""mm between heights, at least: about one printed layer."""


@dataclass(frozen=True, eq=False)
class HeightProfile:
    """Area of the cross-section of all parts at heights of equal spacing, from their lowest to their highest point.

    Attributes
    ----------
    low
        Height of the lowest point of the parts, mm.
    spacing
        mm between heights; the first one is half of this above `low`.
    areas
        ``(k,)`` mm2.
    """

    low: float
    spacing: float
    areas: Floats

    def __post_init__(self) -> None:
        object.__setattr__(self, "areas", frozen(self.areas, np.float64, None))

    @property
    def mean(self) -> float:
        """Mean area, mm2."""
        return float(self.areas.mean()) if len(self.areas) else 0.0

    @property
    def variation(self) -> float:
        """Coefficient of variation of the areas: standard deviation / mean; 0 for equal cross-sections."""
        return float(self.areas.std()) / self.mean if self.mean > 0.0 else 0.0

    @property
    def largest(self) -> float:
        """Largest area / mean."""
        return float(self.areas.max()) / self.mean if self.mean > 0.0 else 0.0

    @property
    def largest_jump(self) -> float:
        """Largest difference of the areas at neighbouring heights / mean."""
        jumps = np.abs(np.diff(self.areas))
        return float(jumps.max(initial=0.0)) / self.mean if self.mean > 0.0 else 0.0


NO_PROFILE = HeightProfile(0.0, LEAST_SPACING, np.empty(0))


def measure_profile(build: Build) -> HeightProfile:
    """Return the height profile of the parts of a build, without supports."""
    meshes = [placed.mesh for placed in build.parts if len(placed.mesh.triangles)]
    if not meshes:
        return NO_PROFILE
    low = min(float(mesh.bounds[0][2]) for mesh in meshes)
    height = max(float(mesh.bounds[1][2]) for mesh in meshes) - low
    count = int(np.clip(np.ceil(height / LEAST_SPACING), 1, MOST_SAMPLES))
    spacing = height / count
    heights = np.asarray(low + spacing * (np.arange(count) + 0.5), np.float64)
    areas = sum(
        (cross_section_areas(mesh.vertices[mesh.triangles], heights) for mesh in meshes), np.zeros(count)
    )
    return HeightProfile(low, spacing, np.maximum(areas, 0.0))
