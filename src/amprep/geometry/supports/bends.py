"""Widths along a leg, in which places that are wider for a short stretch only do not count."""

import math
from collections.abc import Sequence


def without_bends(widths: Sequence[float]) -> list[float]:
    """Return widths of the pieces along a leg without places that are wider in one or two pieces only, such as bends.

    This is the morphological opening over three pieces; beyond the ends the leg counts as wide.
    """
    padded = [math.inf, math.inf, *widths, math.inf, math.inf]
    least = [min(each) for each in zip(padded, padded[1:], padded[2:], strict=False)]
    return [max(each) for each in zip(least, least[1:], least[2:], strict=False)]
