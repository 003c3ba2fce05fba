"""Explain an object of a wrong shape: turned about z, or mirrored."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode.sections import ComparedLayer
from amprep.checks.gcode.shape import missing_from

_COARSE_DEG, _FINE_DEG = 5, 1
_EXPLAINED = 0.05
"""A turn explains the layers if at most this fraction of the outlines is not printed, and half of that without it."""
_MOST_LAYERS = 4
_MOST_POINTS = 400


def explain_turn(layers: Sequence[ComparedLayer], width: float) -> str:
    """Return how an object was turned or mirrored, to follow its name; "" if neither explains its layers.

    Strategy. The outlines of a few layers are mirrored and turned in steps, laid with the centre of their bounding box
    on that of the printed lines, and compared with these; the best angle is refined.

    Parameters
    ----------
    layers
        Some layers of the object, whose sections are at the right heights.
    width
        Width of lines, mm.
    """
    chosen = _telling(layers)
    if not chosen:
        return ""
    centre = _centre([each.points for each in chosen])
    outlines = [each.required[:: max(len(each.required) // _MOST_POINTS, 1)] for each in chosen]

    def fault(angle_deg: int, mirrored: bool) -> float:
        turned = [_turned(each, angle_deg, mirrored) for each in outlines]
        shift = centre - _centre(turned)
        missing = [
            missing_from(layer, each + shift, width) for layer, each in zip(chosen, turned, strict=True)
        ]
        return float(np.mean(missing))

    limit = min(_EXPLAINED, fault(0, False) / 2.0)
    for mirrored in (False, True):
        coarse = min(range(0, 360, _COARSE_DEG), key=lambda angle: fault(angle, mirrored))
        near = range(coarse - _COARSE_DEG + _FINE_DEG, coarse + _COARSE_DEG, _FINE_DEG)
        # the middle of equally good angles
        faults = {angle: fault(angle, mirrored) for angle in near}
        least = min(faults.values())
        best = int(np.median([angle for angle, value in faults.items() if value <= least + 1e-3]))
        if least <= limit and (mirrored or best % 360):
            return _words(best % 360, mirrored)
    return ""


def _telling(layers: Sequence[ComparedLayer]) -> list[ComparedLayer]:
    """Return a few layers with much to compare."""
    good = [each for each in layers if len(each.points) > 20 and len(each.required) > 20 and each.complete]
    step = max(len(good) // _MOST_LAYERS, 1)
    return good[::step][:_MOST_LAYERS]


def _centre(pieces: Sequence[Floats]) -> Floats:
    points = np.concatenate(pieces)
    centre: Floats = (points.min(axis=0) + points.max(axis=0)) / 2.0
    return centre


def _turned(points: Floats, angle_deg: int, mirrored: bool) -> Floats:
    """Return points mirrored in x and then turned about the origin."""
    angle = np.radians(angle_deg)
    matrix = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned: Floats = (points * [-1.0, 1.0] if mirrored else points) @ matrix.T
    return turned


def _words(angle_deg: int, mirrored: bool) -> str:
    if not mirrored:
        return f"it is turned by {angle_deg if angle_deg <= 180 else angle_deg - 360} degrees about z"
    if angle_deg in (0, 180):
        return f"it is mirrored in {'x' if angle_deg == 0 else 'y'}"
    return "it is mirrored and turned"
