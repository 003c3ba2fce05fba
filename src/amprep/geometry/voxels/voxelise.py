"""Exact conservative voxelisation: which voxels of the support grid a mesh meets (thesis 3.2)."""

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import VoxelBlock

UNMARKED = 2**31 - 1
"""Label of a voxel that holds nothing."""

_CONTACT = 1e-3
"""mm; the penetration that counts as contact."""


def met_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s, *, solid: bool = True) -> Bools:
    """Tell which voxels' open interior the solid meets, by its surface or its inside; an array over `block`.

    A penetration of up to 0.001 mm is contact and does not count, so a face on a grid plane leaves both
    sides alone (the inside then marks its own side). What is inside has a winding number above 0. With
    `solid` False only the surface counts.
    """
    from amprep.kernels.voxels.voxelise import count_crossings, mark_interior

    marks = _marked(block, vertices, triangles, grow=-_CONTACT, holds=False)
    if solid and marks.size:
        change = np.zeros(block.shape, np.int16)
        pitch, step = float(block.grid.pitch), float(block.grid.step)
        count_crossings(block.relative(vertices), _indices(triangles), pitch, step, change)
        mark_interior(change, marks)
    return np.asarray(marks != UNMARKED)


def near_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s, gap: float) -> Bools:
    """Tell which voxels have the surface in their sideways neighbourhood: the square widened by `gap` mm."""
    return np.asarray(_marked(block, vertices, triangles, grow=gap - _CONTACT, holds=False) != UNMARKED)


def holding_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s, overhangs: Overhangs) -> Int32s:
    """Label the voxels that hold needy geometry with its least region, others with `UNMARKED`.

    A face, edge or tip on a horizontal grid plane belongs to the voxel above it, the material's side; an edge
    or a tip on an upright grid plane to the voxels on both sides. Intersect with the occupied voxels to keep those
    that have material.
    """
    faces = triangles[overhangs.faces]
    marks = _marked(block, vertices, faces, grow=-_CONTACT, holds=True, labels=overhangs.face_region)
    thin = np.concatenate([overhangs.edges[:, [0, 1, 1]], overhangs.tips[:, None].repeat(3, axis=1)])
    labels = np.concatenate([overhangs.edge_region, overhangs.tip_region])
    return np.minimum(marks, _marked(block, vertices, thin, grow=_CONTACT, holds=True, labels=labels))


def _indices(triangles: NDArray[np.integer]) -> Int64s:
    return np.ascontiguousarray(triangles, np.int64)


def _marked(
    block: VoxelBlock,
    vertices: Floats,
    elements: Int32s,
    *,
    grow: float,
    holds: bool,
    labels: Int32s | None = None,
) -> Int32s:
    from amprep.kernels.voxels.voxelise import mark_elements

    marks = np.full(block.shape, UNMARKED, np.int32)
    if marks.size and len(elements):
        numbers = np.zeros(len(elements), np.int32) if labels is None else np.array(labels, np.int32)
        points = block.relative(vertices)
        pitch, step = float(block.grid.pitch), float(block.grid.step)
        mark_elements(points, _indices(elements), numbers, pitch, step, float(grow), _CONTACT, holds, marks)
    return marks
