"""Fields of many shapes, or of shapes of many pieces, from voxels."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from amprep.arrays import Bools, Int64s, starts_of
from amprep.geometry.no_fit.fields import grids, stored_pairs, unsampled_fields
from amprep.geometry.no_fit.pieces import AXES, BEVELS, ConvexPiece, ShapeSet
from amprep.kernels.no_fit.records import NoFitFields
from amprep.kernels.no_fit.voxels import DEPTHS, FINE, WORD, VoxelShapes, VoxelWork, sample_voxels

GREATER = 0.4
"""Length, in voxels, by which shapes are dilated, so that thin walls are seen.

With 0.25 boundaries are on average where they should be; a little more leaves linear programs fewer and smaller
overlaps to repair, and they can win back the rest.
"""

MOST_THREADS = 2


def sample_from_voxels(shapes: ShapeSet, step: float, stop: Callable[[], bool]) -> NoFitFields | None:
    """Return the fields of all pairs, accurate to about a third of a step; None after a stop."""
    fields = unsampled_fields(shapes, step, np.int8, step / DEPTHS)
    voxels = _voxels_of(shapes, step / FINE, stop)
    if voxels is None:
        return None
    low = grids(shapes, step)[0].astype(np.int64)
    partners: dict[int, list[int]] = {}
    for a, b in stored_pairs(fields):
        partners.setdefault(a, []).append(b)

    def sample(a: int) -> None:
        with_a = np.array(partners[a])
        work = _work_for(voxels, fields, a, with_a)
        if not stop():
            sample_voxels(voxels, fields, low, a, with_a, work)

    with ThreadPoolExecutor(min(os.cpu_count() or 1, MOST_THREADS)) as pool:
        list(pool.map(sample, partners))
    return None if stop() else fields


def _work_for(voxels: VoxelShapes, fields: NoFitFields, a: int, partners: Int64s) -> VoxelWork:
    """Return work arrays for the largest pair."""
    samples = 2 * fields.cells[a, partners]
    x, y, z = samples.T
    words = (FINE * z + WORD - 1) // WORD
    columns = voxels.size[partners, :2].prod(axis=1)
    return VoxelWork(
        np.empty(int((words * columns).max()), np.uint32),
        np.empty(int((words * x * y).max()) * FINE**2, np.uint32),
        np.empty(int((x * y * z).max()) * FINE**2, np.float32),
        np.empty(int((x * y * z).max()) * FINE, np.float32),
        np.empty(int(y.max()) * FINE, np.float32),
    )


def _voxels_of(shapes: ShapeSet, side: float, stop: Callable[[], bool]) -> VoxelShapes | None:
    runs, words, origins, sizes = [], [], [], []
    for number, (shape, clearance) in enumerate(zip(shapes.shapes, shapes.clearance, strict=True)):
        if stop():
            return None
        if number < shapes.moving:
            origin, filled = _filled(shape, side, GREATER * side)
            if shapes.clearance[0] >= side:
                filled = _thinned(filled)
            runs.append(_runs(filled) + np.array([*origin, 0]))
        origin, filled = _filled(shape, side, GREATER * side + float(clearance))
        words.append(_words(filled))
        origins.append(origin)
        sizes.append(filled.shape)
    return VoxelShapes(
        np.concatenate(runs),
        starts_of(runs),
        np.concatenate(words),
        starts_of(words)[:-1],
        np.array(origins, np.int64),
        np.array(sizes, np.int64),
    )


def _filled(shape: Sequence[ConvexPiece], side: float, greater: float) -> tuple[Int64s, Bools]:
    """Return the first voxel of a shape that is dilated by a length, and which voxels have their centre inside."""
    points = np.concatenate([piece.corners for piece in shape])
    first = np.floor((points.min(axis=0) - greater) / side).astype(np.int64)
    end = np.ceil((points.max(axis=0) + greater) / side).astype(np.int64)
    filled = np.zeros(np.maximum(end - first, 1), bool)
    for piece in shape:
        _fill(filled, first, piece, side, greater)
    return first, filled


def _fill(filled: Bools, first: Int64s, piece: ConvexPiece, side: float, greater: float) -> None:
    """Set the voxels of a dilated piece, whose faces are moved outwards, and its edges and corners bevelled."""
    normals = np.concatenate((AXES, BEVELS, piece.faces))
    moved = np.column_stack((normals, (piece.corners @ normals.T).max(axis=0) + greater))
    lo = np.ceil((piece.corners.min(axis=0) - greater) / side - 0.5).astype(np.int64)
    hi = np.floor((piece.corners.max(axis=0) + greater) / side - 0.5).astype(np.int64) + 1
    x, y = ((np.arange(lo[k], hi[k]) + 0.5) * side for k in range(2))
    rest = moved[:, 3] - moved[:, 0] * x[:, None, None] - moved[:, 1] * y[None, :, None]
    slope = moved[:, 2]
    upward, downward, upright = slope > 1e-9, slope < -1e-9, np.abs(slope) <= 1e-9
    top = (rest[:, :, upward] / slope[upward]).min(axis=2)
    bottom = (rest[:, :, downward] / slope[downward]).max(axis=2)
    top[(rest[:, :, upright] < 0.0).any(axis=2)] = -np.inf
    z = (np.arange(lo[2], hi[2]) + 0.5) * side
    inside = (z >= bottom[:, :, None]) & (z <= top[:, :, None])
    i, j, k = lo - first
    filled[i : i + len(x), j : j + len(y), k : k + len(z)] |= inside


def _thinned(filled: Bools) -> Bools:
    """Return voxels without every other one of those that have four neighbours in their layer.

    A shape that is dilated by a voxel or more has no places that are narrower than two voxels, and so overlaps what
    is left, with rare errors of a third of a voxel.
    """
    padded = np.pad(filled, ((1, 1), (1, 1), (0, 0)))
    around = padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
    x, y = np.indices(filled.shape[:2])
    return np.asarray(filled & ~(around & ((x + y) % 2 == 1)[:, :, None]))


def _runs(filled: Bools) -> Int64s:
    """Return the runs ``(r, 4)`` of voxels along z, sorted by length."""
    padded = np.zeros((*filled.shape[:2], filled.shape[2] + 2), np.int8)
    padded[:, :, 1:-1] = filled
    change = np.diff(padded, axis=2)
    starts, ends = np.argwhere(change > 0), np.argwhere(change < 0)
    runs = np.column_stack((starts, ends[:, 2] - starts[:, 2]))
    return np.asarray(runs[np.argsort(runs[:, 3], kind="stable")].astype(np.int64))


def _words(filled: Bools) -> Int64s:
    """Return columns of voxels as bits, flat: words, x, y."""
    x, y, z = filled.shape
    padded = np.zeros((x, y, -(-z // WORD) * WORD), bool)
    padded[:, :, :z] = filled
    packed = np.packbits(padded, axis=2, bitorder="little").view("<u4")
    return np.ascontiguousarray(packed.transpose(2, 0, 1)).ravel()
