"""Match the faces of neighbouring voxels, and place interfaces where their outlines differ."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.merging.voxel_contents import RESOLUTION, ContentsTable


class FilledVoxels(NamedTuple):
    """Voxels of the grid that are not empty.

    Attributes
    ----------
    place
        ``(n, 3)`` x, y, layer.
    contents
        ``(n,)`` numbers of their contents.
    """

    place: Int64s
    contents: Int64s


class MatchedFaces(NamedTuple):
    """Result of `match_faces`.

    Attributes
    ----------
    keep
        ``(n, 6)`` whether a face of a voxel stays in the surface as it is.
    voxel, axis, low, high
        ``(k,)`` shared faces with different outlines: the voxel on the low side, the axis across the face, and the
        numbers of the outlines of the voxels on the low and the high side.
    """

    keep: Bools
    voxel: Int64s
    axis: Int64s
    low: Int64s
    high: Int64s


class PlacedInterfaces(NamedTuple):
    """Copies of one interface: ``(s, 3)`` lattice points, triangles, and splits as in `Interface`."""

    corners: Int64s
    triangles: Int64s
    splits: Int64s


def match_faces(table: ContentsTable, voxels: FilledVoxels) -> MatchedFaces:
    """Compare the two outlines in each face that neighbouring voxels share."""
    keep = np.ones((len(voxels.place), 6), np.bool_)
    outlines = np.array([contents.outlines for contents in table.contents], np.int64)[voxels.contents]
    low = voxels.place.min(axis=0)
    extent = voxels.place.max(axis=0) - low + 2
    step = np.array([1, extent[0], extent[0] * extent[1]])
    key = (voxels.place - low) @ step
    order = np.argsort(key)
    differing = []
    for axis in range(3):
        at = np.minimum(np.searchsorted(key[order], key + step[axis]), len(key) - 1)
        voxel = np.flatnonzero(key[order][at] == key + step[axis])
        neighbour = order[at[voxel]]
        own, other = outlines[voxel, 2 * axis + 1], outlines[neighbour, 2 * axis]
        meet = (own > 0) & (other > 0)
        keep[voxel[meet], 2 * axis + 1] = keep[neighbour[meet], 2 * axis] = False
        differ = meet & (own != other)
        differing.append([voxel[differ], np.full(int(differ.sum()), axis), own[differ], other[differ]])
    return MatchedFaces(keep, *(np.concatenate(column) for column in zip(*differing, strict=True)))


def place_interfaces(
    table: ContentsTable, voxels: FilledVoxels, faces: MatchedFaces
) -> list[PlacedInterfaces] | None:
    """Copy an interface into each face with different outlines; None if an interface cannot be made.

    Parameters
    ----------
    table
        Makes the interfaces.
    voxels, faces
        Filled voxels, and their matched faces.
    """
    rows = np.column_stack([faces.axis, faces.low, faces.high])
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    placed: list[PlacedInterfaces] = []
    first = 0
    for number, (axis, low, high) in enumerate(kinds.tolist()):
        found = table.interface(low, high)
        if found is None:
            return None
        place = voxels.place[faces.voxel[kind.reshape(-1) == number]]
        corners = np.empty((len(found.points), 3), np.int64)
        corners[:, axis], corners[:, [(axis + 1) % 3, (axis + 2) % 3]] = RESOLUTION, found.points
        starts = (first + len(corners) * np.arange(len(place)))[:, None, None]
        triangles = np.concatenate([found.low, found.high[:, ::-1]])
        copies = (
            corners[None] + place[:, None] * RESOLUTION,
            triangles[None] + starts,
            found.splits[None] + starts,
        )
        placed.append(PlacedInterfaces(*(each.reshape(-1, 3) for each in copies)))
        first += len(corners) * len(place)
    return placed
