"""Sample the depth of no-fit solids as fields for the kernels."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Float32s, Floats, Int64s
from amprep.kernels.no_fit.depth import sample_depth
from amprep.kernels.no_fit.records import NoFitFields, NoFitPieces


def sample_fields(pieces: NoFitPieces, step: float, stop: Callable[[], bool]) -> NoFitFields | None:
    """Return the fields of all pairs; None after a stop.

    Grids contain the offset 0 if continued. The depth in a union of convex polyhedra is the greatest of theirs, or,
    where it is greater, the distance to the next sample outside, less a step.
    """
    m = len(pieces.first)
    first, cells = np.full((m, m), -1, np.int64), np.ones((m, m, 3), np.int64)
    origin, values = np.zeros((m, m, 3)), []
    length = 0

    def add(a: int, b: int, at: Floats, samples: Float32s) -> None:
        nonlocal length
        first[a, b], origin[a, b], cells[a, b] = length, at, np.array(samples.shape) // 2
        values.append(_phases(samples))
        length += samples.size

    for a, b in np.argwhere(pieces.end > pieces.first).tolist():
        if stop():
            return None
        at, size = _grid(pieces, a, b, step)
        samples = _sampled(pieces, a, b, at, size, step)
        add(a, b, at, samples)
        if a != b and pieces.end[b, b] > pieces.first[b, b]:
            add(b, a, -(at + (size - 1) * step), samples[::-1, ::-1, ::-1])
    joined = np.concatenate(values) if values else np.zeros(0, np.float32)
    return NoFitFields(joined, first, origin, cells, step)


def _grid(pieces: NoFitPieces, a: int, b: int, step: float) -> tuple[Floats, Int64s]:
    """Return the first point and the even numbers of samples of a grid around the no-fit solid of a pair."""
    box = pieces.box[pieces.first[a, b] : pieces.end[a, b]]
    low = np.floor(box[:, :3].min(axis=0) / step) - 1.0
    count = (np.ceil(box[:, 3:].max(axis=0) / step) + 2.0 - low).astype(np.int64)
    return low * step, count + count % 2


def _sampled(pieces: NoFitPieces, a: int, b: int, at: Floats, size: Int64s, step: float) -> Float32s:
    from scipy.ndimage import distance_transform_edt

    out = np.empty(size.tolist(), np.float32)
    first, end = int(pieces.first[a, b]), int(pieces.end[a, b])
    sample_depth(pieces, first, end, at, step, np.empty(int(size[2]), np.float32), out)
    inside = out > 0.0
    if end - first > 1 and inside.any():
        distance = (distance_transform_edt(inside) - 1.0) * step
        out[inside] = np.maximum(out, distance)[inside]
    return out


def _phases(samples: Float32s) -> Float32s:
    """Return the samples in the order of `NoFitFields.values`."""
    x, y, z = (n // 2 for n in samples.shape)
    return samples.reshape(x, 2, y, 2, z, 2).transpose(1, 3, 5, 0, 2, 4).ravel()
