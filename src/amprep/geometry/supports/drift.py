"""Voxels and paths that are horizontally near enough to the red squares above them."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints

CHUNK = 4_000_000
"""Number of voxels that are searched at once."""


class DriftLimits(NamedTuple):
    """Largest horizontal distance of a support from a red square above it.

    Attributes
    ----------
    pitch, step
        Horizontal and vertical size of a voxel, mm; a distance of one pitch is always allowed.
    ratio
        Largest distance as a fraction of the height between them; 0 for no limit.
    limit
        Largest distance, mm; 0 for no limit.
    """

    pitch: float
    step: float
    ratio: float
    limit: float

    @property
    def most(self) -> float:
        """The largest distance at any height, mm; infinite without a limit."""
        return max(self.limit, self.pitch) if self.limit > 0.0 else np.inf

    def at(self, planes: Ints | int) -> Floats:
        """Return the largest distance (mm) of a voxel whose top is a number of planes below the red square."""
        distance = np.full(np.shape(planes), np.inf)
        if self.ratio > 0.0:
            distance = self.ratio * self.step * np.asarray(planes, np.float64)
        return np.asarray(np.maximum(np.minimum(distance, self.most), self.pitch) + 1e-6 * self.pitch)

    def squares(self, plane: int) -> int:
        """Return the largest number of squares that a path from a plane may lead sideways along x or y."""
        return int(min(float(self.at(plane)) / self.pitch, plane))


# Strategy. A voxel is open if some red square above it is at most max(pitch, min(limit, ratio * height)) away, where
# the height is between the voxel's top and the red square. From the top plane down, two images are kept: the distance
# of the nearest red square above, and the least value of distance - ratio * height, over the red squares that are no
# farther away than the limit. One plane lower each height grows by the step, so the second image only has to be
# lowered by ratio * step. Each plane with red squares adds one exact Euclidean distance transform. The work is
# proportional to the number of voxels.
def within_drift(red: Ints, shape: tuple[int, int, int], limits: DriftLimits) -> Bools:
    """Tell which voxels of a block are within the drift of a red square above them.

    Parameters
    ----------
    red
        ``(m, 3)`` plane, y, x of red squares in the block.
    shape
        Numbers of voxels ``(nz, ny, nx)``.
    limits
        Largest horizontal distances.
    """
    pitch, tolerance = limits.pitch, 1e-6 * limits.pitch
    opened = np.zeros(shape, np.bool_)
    near = np.full(shape[1:], np.inf, np.float32)
    slack = near.copy()
    for k in range(shape[0] - 1, -1, -1):
        slack -= np.float32(limits.ratio * limits.step)
        own = red[red[:, 0] == k + 1]
        if len(own):
            distance = _distances(own[:, 1:], shape[1:], pitch)
            np.minimum(near, distance, out=near)
            distance[distance > limits.most + tolerance] = np.inf
            np.minimum(slack, distance, out=slack)
        if limits.ratio > 0.0:
            opened[k] = (near <= pitch + tolerance) | (slack <= tolerance)
        else:
            opened[k] = (near <= limits.most + tolerance) & np.isfinite(near)
    return opened


def _distances(squares: Ints, shape: tuple[int, ...], pitch: float) -> np.ndarray:
    """Return the distance (mm) of each square of a plane from the nearest of some squares ``(m, 2)``."""
    from scipy.ndimage import distance_transform_edt

    away = np.ones(shape, np.bool_)
    away[tuple(squares.T)] = False
    return np.asarray(distance_transform_edt(away, sampling=pitch), np.float32)


# Strategy. Below a square the cone only becomes wider, so a straight column down from a square in the cone stays in it.
# All red squares are searched at once: the squares that their paths reach are images around each red square, which go
# down plane by plane. A red square is done when one of its squares is above a free column, or when none is left.
def have_path_within(free: Bools, red: Ints, limits: DriftLimits) -> Bools:
    """Tell from which red squares a path leads to the plate that stays within their own drift.

    Parameters
    ----------
    free
        ``(nz, ny, nx)`` bool, the voxels that paths may use.
    red
        ``(m, 3)`` plane, y, x.
    limits
        Largest horizontal distances.
    """
    clear = np.logical_and.accumulate(free, axis=0)  # free down to the plate
    clear = np.concatenate([np.ones_like(clear[:1]), clear])
    done = clear[tuple(red.T)].copy()
    left = np.flatnonzero(~done)
    top = int(red[:, 0].max(initial=0))
    reach = limits.squares(top)
    for chunk in np.array_split(left, max(1, -(-len(left) * (2 * reach + 1) ** 2 // CHUNK))):
        done[chunk] = _sweep(free, clear, red[chunk], reach, limits)
    return np.asarray(done, np.bool_)


def _sweep(free: Bools, clear: Bools, red: Ints, reach: int, limits: DriftLimits) -> Bools:
    """Return `have_path_within` of red squares, whose paths move sideways by at most `reach` squares."""
    around = ((0, 0), (reach, reach), (reach, reach))
    free, clear = np.pad(free, around), np.pad(clear, around)
    side = np.arange(-reach, reach + 1)
    distance = limits.pitch * np.hypot(side[:, None], side)
    done, alive = np.zeros(len(red), np.bool_), np.arange(len(red))
    front = np.zeros((len(red), len(side), len(side)), np.bool_)
    front[:, reach, reach] = True
    for plane in range(int(red[:, 0].max(initial=0)), 0, -1):
        going = np.flatnonzero(red[alive, 0] >= plane)
        own = red[alive[going]]
        rows = own[:, 1, None, None] + side[:, None] + reach
        columns = own[:, 2, None, None] + side + reach
        opened = free[plane - 1][rows, columns] & (distance <= limits.at(own[:, 0] - plane)[:, None, None])
        upper = front[going] & opened
        lower = upper.copy()
        lower[:, 1:] |= upper[:, :-1]
        lower[:, :-1] |= upper[:, 1:]
        lower[:, :, 1:] |= upper[:, :, :-1]
        lower[:, :, :-1] |= upper[:, :, 1:]
        lower &= opened
        front[going] = lower
        arrived = (lower & clear[plane - 1][rows, columns]).any(axis=(1, 2))
        done[alive[going[arrived]]] = True
        ended = np.zeros(len(alive), np.bool_)
        ended[going] = arrived | ~lower.any(axis=(1, 2))
        alive, front = alive[~ended], front[~ended]
    return done
