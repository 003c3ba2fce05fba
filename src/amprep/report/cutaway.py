"""Draws filled parts cut open, so that one sees the cells inside."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Mesh

_SPACE = 0.15
"""Distance between two parts, as a share of their width."""


def draw_cut(parts: Sequence[Mesh], path: Path, *, size: tuple[int, int] = (1600, 1200)) -> None:
    """Write a PNG of parts side by side, each without the quarter that is nearest to the viewer.

    Raises
    ------
    AmprepError
        When the file cannot be written.
    """
    from amprep.report.picture import draw_mesh

    shown, right = [], 0.0
    for part in parts:
        cut = _cut_open(part)
        low, high = part.bounds
        shown.append(Mesh(cut.vertices + np.array([right - low[0], -low[1], -low[2]]), cut.triangles))
        right += float((1.0 + _SPACE) * (high - low)[0])
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in shown])
    joined = Mesh(
        np.concatenate([mesh.vertices for mesh in shown]),
        np.concatenate([mesh.triangles + start for mesh, start in zip(shown, starts, strict=False)]),
    )
    draw_mesh(joined, path, size=size)


def _cut_open(part: Mesh) -> Mesh:
    """Return the part without the quarter in front on the right."""
    from manifold3d import Manifold

    low, high = part.bounds
    middle, room = (low + high) / 2.0, float((high - low).max())
    corner = [float(middle[0]), float(low[1]) - room, float(low[2]) - room]
    size = [2.0 * room, float(middle[1] - low[1]) + room, 3.0 * room]
    cut = as_manifold(*part.arrays) - Manifold.cube(size).translate(corner)
    return Mesh(*arrays_of(cut)) if cut.volume() > 0.0 else part
