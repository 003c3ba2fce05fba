"""Draw filled parts cut open, which shows the cells inside."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.mesh import Mesh, join_meshes

_DISTANCE = 0.15
"""Distance between two parts as a fraction of their width."""


def draw_cut(parts: Sequence[Mesh], path: Path, *, size: tuple[int, int] = (1600, 1200)) -> None:
    """Write a picture of parts side by side as PNG, each without the quarter nearest to the viewer.

    Parameters
    ----------
    parts, path
        The meshes and the file; the file appears complete, or not at all.
    size
        Width and height in pixels.

    Raises
    ------
    AmprepError
        If the file cannot be written.
    """
    from amprep.report.picture import draw_mesh

    shown, right = [], 0.0
    for part in parts:
        cut = _cut_open(part)
        low, high = part.bounds
        shown.append(Mesh(cut.vertices + np.array([right - low[0], -low[1], -low[2]]), cut.triangles))
        right += float((1.0 + _DISTANCE) * (high - low)[0])
    draw_mesh(join_meshes(shown), path, size=size)


def _cut_open(part: Mesh) -> Mesh:
    """Return the part without the quarter in front on the right; the whole part if nothing would remain."""
    from manifold3d import Manifold

    low, high = part.bounds
    middle, room = (low + high) / 2.0, float((high - low).max())
    corner = [float(middle[0]), float(low[1]) - room, float(low[2]) - room]
    size = [2.0 * room, float(middle[1] - low[1]) + room, 3.0 * room]
    cut = as_manifold(*part.arrays) - Manifold.cube(size).translate(corner)
    return Mesh(*arrays_of(cut)) if cut.volume() > 0.0 else part
