"""Voxelise meshes exactly: find the voxels of a grid whose interior a mesh meets (thesis 3.2)."""

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import VoxelBlock

UNMARKED = 2**31 - 1
"""Label of a voxel that contains no overhang."""

_CONTACT = 1e-3
"""Largest penetration (mm) that counts as contact."""


def met_voxels(
    block: VoxelBlock, vertices: Floats, triangles: Int32s | Int64s, *, solid: bool = True
) -> Bools:
    """Tell in which voxels of a block a mesh meets the open interior.

    A penetration of up to 0.001 mm is contact and does not count: a face on a plane of the grid meets neither
    neighbour, but the interior of the solid meets the voxel on its side.

    Parameters
    ----------
    block
        The block of voxels; the result has its shape.
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    solid
        Whether the interior (winding number above 0) counts in addition to the surface.
    """
    marks = _marked(block, vertices, triangles, grow=-_CONTACT, holds=False)
    if solid:
        _mark_centred(block, vertices, triangles, marks)
    return np.asarray(marks != UNMARKED)


def centred_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s | Int64s) -> Bools:
    """Tell which voxels of a block have their centre inside a mesh (winding number above 0).

    Parameters
    ----------
    block
        The block of voxels; the result has its shape.
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    """
    marks = np.full(block.shape, UNMARKED, np.int32)
    _mark_centred(block, vertices, triangles, marks)
    return np.asarray(marks != UNMARKED)


def _mark_centred(block: VoxelBlock, vertices: Floats, triangles: Int32s | Int64s, marks: Int32s) -> None:
    from amprep.kernels.voxels.voxelise import count_crossings, mark_interior

    if marks.size:
        change = np.zeros(block.shape, np.int16)
        pitch, step = float(block.grid.pitch), float(block.grid.step)
        count_crossings(block.relative(vertices), _indices(triangles), pitch, step, change)
        mark_interior(change, marks)


def near_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s, gap: float) -> Bools:
    """Tell which voxels meet the surface when they are widened horizontally by a gap.

    Parameters
    ----------
    block
        The block of voxels; the result has its shape.
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    gap
        Horizontal distance, mm.
    """
    return np.asarray(_marked(block, vertices, triangles, grow=gap - _CONTACT, holds=False) != UNMARKED)


def holding_voxels(block: VoxelBlock, vertices: Floats, triangles: Int32s, overhangs: Overhangs) -> Int32s:
    """Label each voxel with the smallest number of an overhang region in it, else with `UNMARKED`.

    A face, edge or tip on a horizontal plane of the grid belongs to the voxel above, on the side of the material.
    An edge or tip on a vertical plane of the grid belongs to the voxels on both sides; the caller keeps those
    that are occupied.

    Parameters
    ----------
    block
        The block of voxels; the result has its shape.
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    overhangs
        Overhangs of this mesh.
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
    elements: Int32s | Int64s,
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
