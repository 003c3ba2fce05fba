"""The outlines of regions in several planes."""

from typing import NamedTuple

from amprep.arrays import Floats, Int64s


class PlaneOutlines(NamedTuple):
    """The outlines of the regions in some planes, the region to the left of each.

    Attributes
    ----------
    points, first
        ``(n, 2)`` mm, points of all outlines, those of outline c from ``first[c]`` up to ``first[c + 1]``.
    begin
        ``(p + 1,)`` plane k has the outlines from ``begin[k]`` up to ``begin[k + 1]``.
    """

    points: Floats
    first: Int64s
    begin: Int64s
