"""Check that a placement is a rigid motion in an allowed orientation."""

import numpy as np

from amprep.arrays import Floats
from amprep.model.counting import counted
from amprep.model.part import Orientations

ROTATION_TOLERANCE = 5e-6
"""Tolerance of a matrix entry; 3MF files keep six digits."""


def motion_fault(rotation: Floats, orientations: Orientations) -> str:
    """Return the fault of a rotation ``(3, 3)`` as a verb phrase; empty if it is one of `orientations`."""
    if (
        not np.isfinite(rotation).all()
        or np.abs(rotation @ rotation.T - np.eye(3)).max() > 4.0 * ROTATION_TOLERANCE
    ):
        return "changes lengths or angles"
    if np.linalg.det(rotation) < 0.0:
        return "mirrors"
    if orientations.freedom == "free":
        return ""
    if orientations.freedom == "about-z":
        return (
            ""
            if abs(rotation[2, 2] - 1.0) <= ROTATION_TOLERANCE
            else "rotates about an axis other than the vertical"
        )
    nearest = np.abs(orientations.matrices - rotation).max(axis=(1, 2)).min(initial=np.inf)
    if nearest <= ROTATION_TOLERANCE:
        return ""
    return f"is none of the {counted(len(orientations.matrices), 'allowed orientation')}"
