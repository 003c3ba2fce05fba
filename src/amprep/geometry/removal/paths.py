"""Paths of several straight motions that take a body away from others."""

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.geometry.removal.blocking import Blocking

Motion = tuple[tuple[float, ...], float]
"""A unit vector (x, y, z) and a length in mm, infinite for the last motion of a path."""

# Strategy. Breadth first over the offsets of the body. From each, all 26 directions are tried for a motion without end;
# the next offsets are the ends of motions along the axes, at contact and half-way. Motions in contact are exact, so a
# key that fits a slot closely is found: it slides along the walls. A gap that must be entered without a contact to lead
# there is missed.

MOST_MOTIONS = 4000
"""Pairs of bodies that are asked for in the search of one path: about a second for bodies of thousands of triangles."""

MOST_MOTIONS_IN_ALL = 30_000
"""Pairs of bodies that are asked for before no further path is sought."""

SAME = 0.02
"""Offsets are the same if they differ by less than this, as a fraction of the shortest side of the body's box."""

SHORTEST = 1e-2
"""mm; shorter motions are not made."""

AXES = frozen(np.concatenate([np.eye(3), -np.eye(3)]), np.float64)


def _all_directions() -> Floats:
    grid = np.array(
        [(x, y, z) for z in (1, 0, -1) for x in (0, -1, 1) for y in (0, -1, 1) if (x, y, z) != (0, 0, 0)]
    )
    return frozen(grid / np.linalg.norm(grid, axis=1, keepdims=True), np.float64)


ALL_DIRECTIONS = _all_directions()


def find_path(
    blocking: Blocking, body: int, others: Sequence[int], stop: Callable[[], bool]
) -> tuple[Motion, ...] | None:
    """Return motions that take a body away from others without a collision; None if no path is found.

    Parameters
    ----------
    blocking
        The bodies.
    body, others
        The body that moves, and those that keep their positions.
    stop
        Ends the search early, without a path.
    """
    scale = SAME * max(float((blocking.high[body] - blocking.low[body]).min()), 1.0)
    start = np.zeros(3)
    met = {_key(start, scale)}
    queue: deque[tuple[Floats, tuple[Motion, ...]]] = deque([(start, ())])
    most = min(blocking.asked + MOST_MOTIONS, MOST_MOTIONS_IN_ALL)
    while queue and blocking.asked < most and not stop():
        offset, path = queue.popleft()
        for direction in ALL_DIRECTIONS:
            if _travel(blocking, body, others, direction, offset) == np.inf:
                return (*path, (tuple((direction + 0.0).tolist()), np.inf))
        for axis in AXES:
            length = _travel(blocking, body, others, axis, offset)
            for part in (length, 0.5 * length):
                following = offset + part * axis
                if part > SHORTEST and _key(following, scale) not in met:
                    met.add(_key(following, scale))
                    queue.append((following, (*path, (tuple((axis + 0.0).tolist()), part))))
    return None


def _travel(blocking: Blocking, body: int, others: Sequence[int], direction: Floats, offset: Floats) -> float:
    least = np.inf
    for other in others:
        least = min(least, blocking.travel(body, other, direction, offset))
    return least


def _key(offset: Floats, scale: float) -> tuple[int, ...]:
    return tuple(np.round(offset / scale).astype(int).tolist())
