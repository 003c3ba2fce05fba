"""Points that turn about an axis: the angle at which one passes a plane."""

import numpy as np

from amprep.kernels.helper import inlined
from amprep.kernels.trees.records import TOUCH

ROUNDING = 1e-11
"""mm; planes that are exceeded by at most this much in a whole turn are not passed."""


@inlined
def first_exit(cosine: float, sine: float, most: float) -> float:
    """Return the first angle from which ``cosine cos(angle) + sine sin(angle)`` exceeds a value; infinity if never.

    A value that is exceeded now by at most `TOUCH` counts as equal: the angle is 0 if the function rises.
    """
    most = cosine if most < cosine <= most + TOUCH else most
    if cosine > most:
        return 0.0
    amplitude = np.sqrt(cosine * cosine + sine * sine)
    if amplitude <= most + ROUNDING:
        return np.inf
    if cosine == most and (sine > 0.0 or (sine == 0.0 and cosine < 0.0)):
        return 0.0
    angle = (np.arctan2(sine, cosine) - np.arccos(max(-1.0, most / amplitude))) % (2.0 * np.pi)
    if sine > 0.0 and angle > np.pi:
        return 0.0
    return angle
