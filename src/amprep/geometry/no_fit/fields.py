"""Sample the depth of no-fit solids as fields for the kernels."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import DTypeLike

from amprep.arrays import Bools, Float32s, Floats, Int64s
from amprep.geometry.no_fit.pieces import ShapeSet, no_fit_solid
from amprep.kernels.no_fit.depth import sample_depth
from amprep.kernels.no_fit.records import NoFitFields, NoFitSolid


def sample_fields(shapes: ShapeSet, step: float, stop: Callable[[], bool]) -> NoFitFields | None:
    """Return the fields of the exact no-fit solids of all pairs; None after a stop.

    The depth in a union of convex polyhedra is the greatest of theirs, or, where it is greater, the distance to the
    next sample outside, less a step.
    """
    fields = unsampled_fields(shapes, step, np.float32, 1.0)
    for a, b in stored_pairs(fields):
        if stop():
            return None
        solid = no_fit_solid(shapes.shapes[b], shapes.shapes[a], float(shapes.clearance[b]))
        values = _phases(_sampled(solid, fields.origin[a, b], 2 * fields.cells[a, b], step))
        start = int(fields.first[a, b])
        fields.values[start : start + values.size] = values
    return fields


def unsampled_fields(shapes: ShapeSet, step: float, dtype: DTypeLike, scale: float) -> NoFitFields:
    """Return fields of all pairs of moving shapes, and of them with obstacles, whose values are still to be written.

    A grid is around the box of the no-fit solid, with a sample more on each side, and an even number along each axis.
    It contains the offset 0 if continued.
    """
    low, count = grids(shapes, step)
    n, m = len(shapes.shapes), shapes.moving
    a, b = np.indices((n, n))
    stored = _stored(shapes)
    sizes = np.where(stored, count.prod(axis=2), 0)
    first = np.where(stored, np.cumsum(sizes).reshape(n, n) - sizes, -1)
    mirrored = (b > a) & (b < m)
    first = np.where(mirrored, (first + sizes).T - 1, first)
    origin = np.where(mirrored[:, :, None], -(low + count - 1).transpose(1, 0, 2), low) * step
    cells = np.where(mirrored[:, :, None], count.transpose(1, 0, 2), count) // 2
    stride = np.where(mirrored, -1, 1)
    values = np.empty(int(sizes.sum()), dtype)
    return NoFitFields(values, scale, first, stride, np.ascontiguousarray(origin), cells, step)


def samples(shapes: ShapeSet, step: float) -> int:
    """Return the number of samples of all fields with some step, mm."""
    return int(grids(shapes, step)[1].prod(axis=2)[_stored(shapes)].sum())


def _stored(shapes: ShapeSet) -> Bools:
    """Return which pairs of shapes have samples, ``(n, n)``."""
    a, b = np.indices((len(shapes.shapes), len(shapes.shapes)))
    return np.asarray((a < shapes.moving) & ((b <= a) | (b >= shapes.moving)))


def grids(shapes: ShapeSet, step: float) -> tuple[Floats, Int64s]:
    """Return the first point, in steps, and the numbers of samples of the grid of each pair, ``(n, n, 3)``."""
    lo, hi = shapes.boxes
    gap = shapes.clearance[None, :, None]
    low = np.floor((lo[None] - hi[:, None] - gap) / step) - 1.0
    count = (np.ceil((hi[None] - lo[:, None] + gap) / step) + 2.0 - low).astype(np.int64)
    return low, count + count % 2


def stored_pairs(fields: NoFitFields) -> Iterator[tuple[int, int]]:
    """Yield the pairs whose samples are stored."""
    yield from zip(
        *(axis.tolist() for axis in np.nonzero((fields.first >= 0) & (fields.stride > 0))), strict=True
    )


def _sampled(solid: NoFitSolid, at: Floats, size: Int64s, step: float) -> Float32s:
    from scipy.ndimage import distance_transform_edt

    out = np.empty(size.tolist(), np.float32)
    sample_depth(solid, at, step, np.empty(int(size[2]), np.float32), out)
    inside = out > 0.0
    if len(solid.box) > 1 and inside.any():
        distance = (distance_transform_edt(inside) - 1.0) * step
        out[inside] = np.maximum(out, distance)[inside]
    return out


def _phases(samples: Float32s) -> Float32s:
    """Return the samples in the order of `NoFitFields.values`."""
    x, y, z = (n // 2 for n in samples.shape)
    return samples.reshape(x, 2, y, 2, z, 2).transpose(1, 3, 5, 0, 2, 4).ravel()
