"""Improve a covering with boxes: replace two of its boxes at a time by the best two for what they cover."""

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.fit import enlarged, shrink
from amprep.geometry.bounding.boxes.polygons import ConvexPolygons, outside
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch, two_boxes
from amprep.geometry.bounding.boxes.union import union_volume

_LEAST_GAIN = 1e-6
"""Fraction of the volume by which a step must improve it."""


def improve(
    polygons: ConvexPolygons,
    boxes: Floats,
    count: int,
    search: TwoBoxSearch,
    *,
    preferred: Sequence[Floats],
    passes: int,
    stop: Callable[[], bool],
) -> Floats:
    """Reduce the union of boxes that cover polygons; return at most `count` boxes, ``(k, 6)``.

    Strategy: what two of the boxes cover alone is covered again by the two best boxes for it, while the volume of
    the others is free; pair after pair, until a pass over all pairs gains nothing. Before, the others are enlarged
    as far as the union of all boxes reaches: that costs nothing, and leaves less for the two. Faces move by any
    distance, not by cells, and every covering in between is exact. Where there are fewer boxes than allowed, one
    is replaced by two.

    Parameters
    ----------
    polygons, boxes
        The boxes cover the polygons.
    count
        Greatest number of boxes, at most 4.
    search
        Settings of each search for two boxes.
    preferred
        As in `two_boxes`.
    passes
        Greatest number of passes.
    stop
        Tells when to return the best boxes so far.
    """
    boxes = shrink(polygons, boxes)
    for _ in range(passes):
        before = union_volume(boxes)
        for chosen in _pairs(len(boxes), count):
            if stop():
                return boxes
            if max(chosen) < len(boxes) and (len(chosen) == 2 or len(boxes) < count):
                boxes = _with_best_two(polygons, boxes, chosen, search, preferred)
        boxes = shrink(polygons, boxes)
        if union_volume(boxes) > before * (1 - _LEAST_GAIN):
            break
    return boxes


def _pairs(have: int, count: int) -> list[tuple[int, ...]]:
    """Return the boxes that are replaced together: one at a time where one more is allowed, else two."""
    return list(combinations(range(have), 1 if have < count else 2))


def _with_best_two(
    polygons: ConvexPolygons,
    boxes: Floats,
    chosen: tuple[int, ...],
    search: TwoBoxSearch,
    preferred: Sequence[Floats],
) -> Floats:
    others = enlarged(boxes, [number for number in range(len(boxes)) if number not in chosen])
    alone = outside(polygons, others)
    if not len(alone.points):
        return others
    known = union_volume(boxes)
    limit = known * (1 - _LEAST_GAIN) - union_volume(others)
    pair, _ = two_boxes(alone, search, preferred=preferred, covered=others, limit=limit)
    better = np.vstack((others, pair))
    return better if len(pair) and union_volume(better) < known else boxes
