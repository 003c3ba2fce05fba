"""Find closed cavities in solids, however narrow, by the orientation of their shells."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, MeshArrays
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.shells import measure_shells
from amprep.geometry.powder.pockets import Pocket

GRAIN = 1e-4
"""Volume (mm3) below which a closed cavity holds hardly a grain of powder: a ball of 0.06 mm in diameter."""


def find_cavities(solid: MeshArrays, pockets: Sequence[Pocket] = ()) -> list[Pocket]:
    """Return the closed cavities of a solid in which no known pocket is, the largest first.

    A cavity is a shell that encloses a negative volume. Those of less than `GRAIN` are left out.

    Parameters
    ----------
    solid
        ``(n, 3)`` mm and ``(m, 3)``; shells are oriented outwards.
    pockets
        Pockets that a flood fill has found.
    """
    vertices, triangles = solid
    if not len(triangles):
        return []
    shells = measure_shells(vertices, triangles)
    points = np.array([each.point for each in pockets]).reshape(-1, 3)
    order = np.argsort(shells.label, kind="stable")
    first = np.searchsorted(shells.label[order], np.arange(len(shells.volume) + 1))
    found = []
    for number in np.flatnonzero(shells.volume < -GRAIN).tolist():
        own = triangles[order[first[number] : first[number + 1]]]
        low, high = shells.lo[number], shells.hi[number]
        near = points[((points >= low) & (points <= high)).all(axis=1)]
        if inside(near, vertices, own[:, ::-1].astype(np.int32)).any():
            continue
        volume = float(-shells.volume[number])
        point = _point_in(vertices[own], volume)
        found.append(Pocket(volume, _three(point), _three(low), _three(high), closed=True))
    return sorted(found, key=lambda each: -each.volume)


def _point_in(corners: Floats, volume: float) -> Floats:
    """Return a point of a cavity: beside the middle of its largest triangle, whose normal points into it."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    largest = int(doubled.argmax())
    width = 4.0 * volume / doubled.sum()
    inwards = normals[largest] / doubled[largest]
    return np.asarray(corners[largest].mean(axis=0) + inwards * (width / 4.0))


def _three(point: Floats) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
