"""Judge that everything printed lies on the bed and below the top of the build volume."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode.found import SlicedObject, SlicedPlate
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
        corners = np.array([[x, y] for x in (body.low[0], body.high[0]) for y in (body.low[1], body.high[1])])
        if len(plate.bed):
            beyond = not _all_inside(corners, plate.bed)
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


def _all_inside(corners: Floats, bed: Floats) -> bool:
    """Tell whether corners lie inside the box around the bed, or in the bed where it is no rectangle.

    A box that is round or has more corners is judged by its inscribed shape: the corners of the extent of an object
    may lie outside of a round bed, its middle lines may not.
    """
    low, high = bed.min(axis=0) - _TOLERANCE, bed.max(axis=0) + _TOLERANCE
    if not bool(np.all(corners >= low) and np.all(corners <= high)):
        return False
    if len(bed) <= 4:
        return True
    middles = np.array([(corners[i] + corners[j]) / 2.0 for i, j in ((0, 1), (0, 2), (1, 3), (2, 3))])
    centre = (low + high) / 2.0
    return bool(np.all(np.linalg.norm((middles - centre) / ((high - low) / 2.0), axis=1) <= 1.0 + 1e-6))
