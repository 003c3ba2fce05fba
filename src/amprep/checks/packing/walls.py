"""Measure the distance of points to the walls and the top of a build volume."""

import numpy as np

from amprep.arrays import Floats
from amprep.model.build_volume import BuildVolume


def wall_distances(points: Floats, space: BuildVolume) -> dict[str, float]:
    """Return the least distance of points ``(n, 3)`` to the walls and to the top (mm); negative if outside."""
    size = space.size
    if space.shape == "cylinder":
        away = points[:, :2] - size[:2] / 2.0
        walls = float(size[0]) / 2.0 - float(np.hypot(away[:, 0], away[:, 1]).max())
    else:
        walls = float(min(points[:, :2].min(), (size[:2] - points[:, :2]).min()))
    return {"walls": walls, "top": float(size[2] - points[:, 2].max())}
