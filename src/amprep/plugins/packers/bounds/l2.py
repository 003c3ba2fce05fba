"""The lower bound L2 of Martello, Pisinger and Vigo for three-dimensional bin packing, with clearance."""

import numpy as np

from amprep.arrays import Floats

MOST_THRESHOLDS, FEWEST_THRESHOLDS, MANY = 200, 20, 2000
"""Most and fewest lengths tried as p and q, and the number of boxes from which fewer are tried.

Fewer lengths give a weaker bound, in reasonable time for thousands of boxes.
"""


def l2_bound(size: Floats, room: Floats, gap: float) -> int:
    """Return a lower bound on the number of builds for boxes of fixed orientation.

    After *The three-dimensional bin packing problem*, Operations Research 48 (2000), bounds L1 and L2,
    doi:10.1287/opre.48.2.256.12386. Two boxes that together are wider and deeper than the room are
    `gap` apart along the third axis. So lengths along it include the gap, and volumes are those of boxes
    grown by a ball of half the gap.

    Parameters
    ----------
    size
        ``(n, 3)`` mm sides of the boxes.
    room
        ``(3,)`` mm sides of the room.
    gap
        Least distance between two boxes, mm.
    """
    if not len(size):
        return 0
    return max(_along(size[:, axes], room[list(axes)], gap) for axes in ((0, 1, 2), (0, 2, 1), (1, 2, 0)))


def _along(size: Floats, room: Floats, gap: float) -> int:
    """Return the bound from the boxes that can be beside each other along the third axis only."""
    width, height = size[:, 0], size[:, 1]
    length, whole = size[:, 2] + gap, float(room[2] + gap)
    both = (width > room[0] / 2.0) & (height > room[1] / 2.0)
    lined_up = _one_dimensional(length[both], whole)
    grown = grown_volume(size, gap / 2.0)
    floor = float((room[0] + gap) * (room[1] + gap))
    p = _thresholds(np.append(width[width <= room[0] / 2.0], room[0] / 2.0))
    q = _thresholds(np.append(height[height <= room[1] / 2.0], room[1] / 2.0))
    too_wide, too_high = width > room[0] - p[:, None], height > room[1] - q[:, None]
    blocking = (too_wide * (length * both)) @ too_high.T
    blocking_volume = (too_wide * (grown * both)) @ too_high.T
    small_volume = ((width >= p[:, None]) * (grown * ~both)) @ (height >= q[:, None]).T
    volume = grown[both].sum() - blocking_volume + small_volume
    more = (volume - (whole * lined_up - blocking) * floor) / (whole * floor)
    return lined_up + max(0, int(np.ceil(more.max() - 1e-9)))


def _thresholds(length: Floats) -> Floats:
    """Return the different lengths, evenly chosen when there are too many."""
    found = np.unique(length)
    most = max(FEWEST_THRESHOLDS, min(MOST_THRESHOLDS, MOST_THRESHOLDS * MANY // max(len(length), 1)))
    if len(found) > most:
        found = found[np.linspace(0, len(found) - 1, most).astype(np.int64)]
    return found


def grown_volume(size: Floats, radius: float) -> Floats:
    """Return the volumes of boxes ``(n, 3)`` grown by a ball."""
    x, y, z = size.T
    faces = 2.0 * radius * (x * y + y * z + x * z)
    return np.asarray(x * y * z + faces + np.pi * radius**2 * (x + y + z) + 4.0 / 3.0 * np.pi * radius**3)


def _one_dimensional(length: Floats, whole: float) -> int:
    """Return the bound L1: bins of length `whole` for items of one dimension."""
    large, small = length[length > whole / 2.0], length[length <= whole / 2.0]
    if not len(small):
        return len(large)
    p = _thresholds(small)[:, None]
    counted, beside = small >= p, large <= whole - p
    by_length = (counted @ small - beside.sum(axis=1) * whole + beside @ large) / whole
    room_beside = (np.floor((whole - large) / np.maximum(p, 1e-12)) * beside).sum(axis=1)
    by_count = (counted.sum(axis=1) - room_beside) / np.floor(whole / np.maximum(p[:, 0], 1e-12))
    return len(large) + max(0, int(np.ceil(max(by_length.max(), by_count.max()) - 1e-9)))
