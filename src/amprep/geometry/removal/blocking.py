"""Whether bodies block the straight motions of others."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.geometry.removal.above import MOST_TRIANGLES, is_above
from amprep.geometry.removal.bodies import MovableBody
from amprep.geometry.trees.queries import directional_distances

SETBACK = 1e-3
"""mm; a motion is judged from this far behind, because bodies in contact may overlap by as much."""

UPWARDS = np.array([0.0, 0.0, 1.0])

SLIDING = 1e-4
"""mm; bounding boxes that overlap by less than this pass each other."""


class Blocking:
    """Answers of all pairs of bodies that were asked for: a body is blocked if its motion hits another.

    Parameters
    ----------
    bodies
        The bodies of a build, which must not overlap by more than `SETBACK`.
    directions
        ``(d, 3)`` unit vectors, in which the bodies may leave.

    Attributes
    ----------
    asked
        Number of queries on meshes so far.
    triangles
        Triangles of the trees that these needed.
    """

    def __init__(self, bodies: Sequence[MovableBody], directions: Floats) -> None:
        self.bodies = tuple(bodies)
        self.directions = directions
        self.low = np.array([body.low.min(axis=0) for body in bodies]).reshape(-1, 3)
        self.high = np.array([body.high.max(axis=0) for body in bodies]).reshape(-1, 3)
        self.asked = 0
        self.triangles = 0
        self._known: dict[tuple[int, int, int], bool] = {}

    def candidates(self, body: int, others: Ints, k: int) -> Ints:
        """Return those of the others ``(n,)`` whose boxes the box of a body hits in direction k."""
        met = boxes_met(
            self.low[body], self.high[body], self.low[others], self.high[others], self.directions[k]
        )
        found: Ints = others[met & (others != body)]
        return found

    def is_blocked(self, body: int, other: int, k: int) -> bool:
        """Tell whether a body that leaves in direction k hits another."""
        key = body, other, k
        if key not in self._known:
            upwards = bool(self.directions[k, 2] == 1.0)
            answer = self._is_below(body, other) if upwards else None
            self._known[key] = (
                self.travel(body, other, self.directions[k]) < np.inf if answer is None else answer
            )
        return self._known[key]

    def _is_below(self, body: int, other: int) -> bool | None:
        """Tell whether something of another body is above a body; None if that is better asked of their trees."""
        one, two = self.bodies[body], self.bodies[other]
        for i, shape in enumerate(one.shapes):
            met = boxes_met(one.low[i], one.high[i], two.low, two.high, UPWARDS)
            for j in np.flatnonzero(met):
                sizes = len(shape.triangles) + len(two.shapes[j].triangles)
                if sizes > MOST_TRIANGLES or (shape.is_built and two.shapes[j].is_built):
                    return None
                answer = is_above(two.triangles(int(j)), one.triangles(i), SETBACK)
                if answer or answer is None:
                    return answer
        return False

    def travel(self, body: int, other: int, direction: Floats, offset: Floats | None = None) -> float:
        """Return how far a body may travel until it touches another one, mm; infinity if it never does.

        Parameters
        ----------
        direction
            ``(3,)`` unit vector.
        offset
            ``(3,)`` mm by which the body has been moved already.
        """
        one, two, moved = self.bodies[body], self.bodies[other], np.zeros(3) if offset is None else offset
        least = np.inf
        for i, shape in enumerate(one.shapes):
            pose = one.poses[i].copy()
            pose[:3, 3] += moved - SETBACK * direction
            met = boxes_met(one.low[i] + moved, one.high[i] + moved, two.low, two.high, direction)
            for j in np.flatnonzero(met):
                self.asked += 1
                self.triangles += sum(
                    len(each.triangles) for each in (shape, two.shapes[j]) if not each.is_built
                )
                found = directional_distances(shape.tree, two.shapes[j].tree, pose, two.poses[j], direction)
                least = min(least, float(found[0]) - SETBACK)
        return max(least, 0.0)


def boxes_met(low: Floats, high: Floats, other_low: Floats, other_high: Floats, direction: Floats) -> Bools:
    """Tell which boxes block a box that leaves in a direction, ``(n,)``.

    Parameters
    ----------
    low, high
        ``(3,)`` mm, corners of the box that moves.
    other_low, other_high
        ``(n, 3)`` mm, corners of the others.
    direction
        ``(3,)``
    """
    least, most = other_low - high + SLIDING, other_high - low - SLIDING
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([least / direction, most / direction])
    still = direction == 0.0
    inside = (least < 0.0) & (most > 0.0)
    first = np.where(still, np.where(inside, -np.inf, np.inf), ends.min(axis=0))
    last = np.where(still, np.where(inside, np.inf, -np.inf), ends.max(axis=0))
    met: Bools = (first.max(axis=1) < last.min(axis=1)) & (last.min(axis=1) > 0.0)
    return met
