"""Overhanging faces of the merged surface."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.overhangs.surface import Surface, above_plate

ANGLE_TOLERANCE_DEG = 0.01
"""Geometry this close to the threshold angle counts as steep enough."""


def overhanging_faces(surface: Surface, normals: Floats, angle_deg: float) -> Bools:
    """Tell which faces above the plate are flatter than the overhang angle."""
    steep_enough = np.cos(np.radians(max(angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    return np.asarray(above_plate(surface) & (-normals[:, 2] > steep_enough))
