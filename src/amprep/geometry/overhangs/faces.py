"""Find the overhanging faces of a surface."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.overhangs.surface import Surface, above_plate

ANGLE_TOLERANCE_DEG = 0.01
"""Geometry this close to the overhang angle counts as steep enough."""


def overhanging_faces(surface: Surface, normals: Floats, angle_deg: float, plate: float) -> Bools:
    """Tell which downward faces above the height `plate` have a smaller angle to the plate than `angle_deg`."""
    steep_enough = np.cos(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    return np.asarray(above_plate(surface, plate) & (-normals[:, 2] > steep_enough))
