"""Judge the overhangs that a build lists as enclosed: no free column may lead from them to the build plate."""

from collections import Counter
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.violation import Violation, place_words
from amprep.model.build import Build, Unsupported
from amprep.model.counting import counted
from amprep.model.supports import ENCLOSED, TERRITORY

PROMISE = "listed overhangs"
"""Name of the promise."""

_JUDGED = (ENCLOSED, TERRITORY)
"""Reasons that say that no way leads to the plate."""

_LEAST_SQUARE, _MOST_SQUARE = 0.5, 5.0
"""Bounds (mm) of the side of a square: a file may state any."""

_POINTS = 16
"""Largest number of points of a region that are judged."""

_MOST_WORK = 2e9
"""Largest number of pairs of a point and a triangle; regions beyond it are not judged."""

# Strategy. A file that claims too much hides missing supports: a region that is listed needs none. That a region has no
# way to the plate cannot be judged in general without planning, but the opposite is easy to see: a column two squares
# to each side, with nothing of any part or support in it, from one step below the region down to the plate. Triangles
# count by their boxes, so that a column is only called free if it is.


class _TriangleBoxes(NamedTuple):
    """Boxes of triangles: least and greatest corners ``(n, 3)`` mm."""

    low: Floats
    high: Floats

    def meet(self, low: Floats, high: Floats) -> Bools:
        """Tell which of them meet a box in plan."""
        return np.asarray(((self.low[:, :2] < high[:2]) & (self.high[:, :2] > low[:2])).all(axis=1))

    def within(self, low: Floats, high: Floats) -> "_TriangleBoxes":
        """Return those that meet a box in plan."""
        near = self.meet(low, high)
        return _TriangleBoxes(self.low[near], self.high[near])


def check_listed(build: Build) -> list[Violation]:
    """Return the regions that are listed as enclosed or outside the territory though a free column leads to the plate.

    A region must also not be listed for points farther than the reach of the supports.
    """
    settings = build.settings
    reach = max([settings.reach, *(settings.reach_of(body) for body in build.supports)])
    found = [
        Violation(
            PROMISE,
            each.label,
            f"listed up to {each.radius:.4g} mm around its points, expected {reach:.4g} mm",
        )
        for each in build.unsupported
        if each.radius > reach * (1.0 + 1e-6)
    ]
    judged = [each for each in build.unsupported if each.reason in _JUDGED and len(each.points)]
    if not judged:
        return found
    square = float(np.clip(settings.sizes.square_mm, _LEAST_SQUARE, _MOST_SQUARE))
    step = square * float(np.tan(np.radians(settings.rules.strut_angle_deg)))
    columns = _FreeColumns(build, 2.0 * square + settings.rules.gap_mm, step)
    for region in judged:
        free = columns.free_at(region)
        if len(free):
            message = (
                f"listed with the reason '{region.reason}', but the column below it is free down to the plate, "
                f"for example at {place_words(free[0])} mm"
            )
            found.append(Violation(PROMISE, region.label, message))
    return found


def extent_of(build: Build, not_judged: str) -> str:
    """Return how many regions a build lists as unsupported, with their areas and reasons; they are no violations."""
    faults = [each for each in build.unsupported if not each.minor]
    if not build.unsupported:
        return f"{not_judged}: none is listed"
    counts = Counter(each.reason for each in faults)
    reasons = ", ".join(f"{number} {reason}" for reason, number in sorted(counts.items()))
    area = sum(each.measure for each in faults if each.kind == "face")
    words = f"{counted(len(faults), 'region')} of {area:.4g} mm2 not supported"
    words += f" ({reasons})" if reasons else ""
    minor = len(build.unsupported) - len(faults)
    return f"{words}, {minor} minor or excepted" if minor else words


class _FreeColumns:
    """Looks for free columns in a build."""

    def __init__(self, build: Build, half: float, step: float) -> None:
        meshes = [placed.mesh for placed in build.parts] + [body.mesh for body in build.supports]
        corners = [mesh.vertices[mesh.triangles] for mesh in meshes if len(mesh.triangles)]
        self._obstacles = [_TriangleBoxes(each.min(axis=1), each.max(axis=1)) for each in corners]
        self._bounds = _TriangleBoxes(
            np.array([each.low.min(axis=0) for each in self._obstacles]).reshape(-1, 3),
            np.array([each.high.max(axis=0) for each in self._obstacles]).reshape(-1, 3),
        )
        self._space, self._half, self._step = build.settings.space, half, step
        self._work = 0.0

    def free_at(self, region: Unsupported) -> Floats:
        """Return the points of a region, of few that are judged, from which a free column leads to the plate."""
        chosen = np.linspace(0, len(region.points) - 1, min(len(region.points), _POINTS)).astype(np.int64)
        points = region.points[chosen]
        points = points[self._is_inside(points) & (points[:, 2] > 2.0 * self._step)]
        if not len(points):
            return points
        near = self._obstacles_in(points.min(axis=0) - self._half, points.max(axis=0) + self._half)
        self._work += len(points) * len(near.low)
        if self._work > _MOST_WORK:
            return points[:0]
        return points[[self._is_free(point, near) for point in points]]

    def _obstacles_in(self, low: Floats, high: Floats) -> _TriangleBoxes:
        """Return the triangles of parts and supports that meet a box in plan."""
        found = []
        for number in np.flatnonzero(self._bounds.meet(low, high)).tolist():
            self._work += len(self._obstacles[number].low)
            found.append(self._obstacles[number].within(low, high))
        none = np.empty((0, 3))
        return _TriangleBoxes(
            np.concatenate([none, *(each.low for each in found)]),
            np.concatenate([none, *(each.high for each in found)]),
        )

    def _is_free(self, point: Floats, near: _TriangleBoxes) -> bool:
        """Tell whether nothing is in the column below a point, from one step below it."""
        beside = near.within(point - self._half, point + self._half)
        return not (beside.low[:, 2] < point[2] - self._step).any()

    def _is_inside(self, points: Floats) -> Bools:
        """Tell from which points columns are inside the build volume and outside its zones."""
        space, half = self._space, self._half
        inside = ((points[:, :2] > half) & (points[:, :2] < space.size[:2] - half)).all(axis=1)
        if space.shape == "cylinder":
            away = np.linalg.norm(points[:, :2] - space.size[:2] / 2.0, axis=1)
            inside &= away < space.size[0] / 2.0 - half * np.sqrt(2.0)
        for low, high in zip(space.zone_lo, space.zone_hi, strict=True):
            meets = ((points[:, :2] > low[:2] - half) & (points[:, :2] < high[:2] + half)).all(axis=1)
            inside &= ~(meets & (low[2] < points[:, 2]))
        return np.asarray(inside)
