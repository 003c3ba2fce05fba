"""Judge that everything printed lies on the bed and below the top of the build volume."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.gcode.found import SlicedBody, SlicedObject, SlicedPlate
from amprep.checks.gcode.sections import line_points
from amprep.checks.violation import Violation, place_words
from amprep.model.build_volume import BuildVolume

PROMISE = "on the bed"
_TOLERANCE = 0.05


def check_bed(
    printed: Sequence[tuple[str, SlicedObject]], plate: SlicedPlate, space: BuildVolume
) -> list[Violation]:
    """Return the objects, each with its label, that reach beyond the bed or above the build volume."""
    found = []
    for label, each in printed:
        body = each.body
        if len(plate.bed):
            beyond = not _is_on(body, plate.bed)
        else:
            beyond = bool(
                np.any(body.low[:2] < -_TOLERANCE) or np.any(body.high[:2] > space.size[:2] + _TOLERANCE)
            )
        if beyond:
            message = f"reaches from {place_words(body.low)} to {place_words(body.high)} mm, beyond the bed"
            found.append(Violation(PROMISE, label, message))
        if body.high[2] > space.size[2] + _TOLERANCE:
            message = f"is {body.high[2]:.2f} mm high, the build volume {space.size[2]:g} mm"
            found.append(Violation(PROMISE, label, message))
    return found


def extent_words(plate: SlicedPlate) -> str:
    """Return what was judged."""
    return "by the bed of the slicer" if len(plate.bed) else "by the build volume, the G-code states no bed"


def _is_on(body: SlicedBody, bed: Floats) -> bool:
    """Tell whether the extent of a body is inside the box around the bed, and its recorded lines are on the bed."""
    low, high = bed.min(axis=0) - _TOLERANCE, bed.max(axis=0) + _TOLERANCE
    if np.any(body.low[:2] < low) or np.any(body.high[:2] > high):
        return False
    return all(bool(_are_inside(line_points(each.lines)[0], bed).all()) for each in body.samples)


def _are_inside(points: Floats, outline: Floats) -> Bools:
    """Tell which points ``(n, 2)`` mm are inside a polygon ``(k, 2)``, or within the tolerance of its border.

    A point is inside if a line from it in the direction of x crosses the border an odd number of times.
    """
    inside, near = np.zeros(len(points), np.bool_), np.zeros(len(points), np.bool_)
    x, y = points.T
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = end - start
        part = np.clip((points - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
        near |= np.linalg.norm(points - start - part[:, None] * along, axis=1) <= _TOLERANCE
        if along[1]:
            crosses = (start[1] > y) != (end[1] > y)
            inside ^= crosses & (x < start[0] + (y - start[1]) * along[0] / along[1])
    return inside | near
