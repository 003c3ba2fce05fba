"""Poses of bodies as rows for the kernels on trees."""

import numpy as np

from amprep.arrays import Floats


def pose_rows(*poses: Floats, count: int = 1) -> tuple[Floats, ...]:
    """Return rigid motions as ``(n, 12)`` rows of their ``(3, 4)`` matrices, all of one length.

    Parameters
    ----------
    poses
        ``(4, 4)`` or ``(n, 4, 4)`` each; n is the same for all that are not single.
    count
        Least length of the result if all are single.
    """
    rows = [np.asarray(each, np.float64)[..., :3, :].reshape(-1, 12) for each in poses]
    lengths = {len(each) for each in rows if len(each) != 1} or {count}
    return tuple(np.array(np.broadcast_to(each, (max(lengths), 12)), order="C") for each in rows)


def unit_vectors(directions: Floats, count: int) -> Floats:
    """Return ``(3,)`` or ``(n, 3)`` directions as ``(count, 3)`` unit vectors."""
    along = np.broadcast_to(np.asarray(directions, np.float64), (count, 3))
    return np.ascontiguousarray(along / np.linalg.norm(along, axis=1, keepdims=True))
