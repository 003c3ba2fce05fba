"""Shrink boxes that cover polygons to what only they must cover, or enlarge them where it costs nothing."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.polygons import ConvexPolygons, outside
from amprep.geometry.bounding.boxes.union import union_volume, volumes

MARGIN = 2e-7
"""Length (mm) by which faces of boxes are moved outwards at the end; two of them are less than packers call contact."""


def shrink(polygons: ConvexPolygons, boxes: Floats) -> Floats:
    """Shrink each box to what the others leave uncovered; return the boxes that are left, ``(k, 6)``.

    The boxes are shrunk one after another, the largest first and the smallest first; the smaller union counts,
    then the smaller sum of volumes. Afterwards no box can be shrunk alone. The last box encloses all that the others
    leave uncovered, so the result covers the polygons even where the given boxes do not.

    Parameters
    ----------
    polygons
        What the boxes cover afterwards.
    boxes
        ``(k, 6)``, k at least 1.
    """
    order = np.argsort(volumes(boxes), kind="stable")
    results = [_shrunk_in(polygons, boxes, list(way)) for way in (order[::-1], order)]
    return min(results, key=lambda result: (round(union_volume(result), 9), volumes(result).sum()))


def _shrunk_in(polygons: ConvexPolygons, boxes: Floats, order: list[int]) -> Floats:
    boxes = boxes.copy()
    kept = np.ones(len(boxes), np.bool_)
    for number in order:
        kept[number] = False
        needed = outside(polygons, boxes[kept]).bounds
        if needed[0] <= needed[3]:
            boxes[number] = needed
            kept[number] = True
    return np.asarray(boxes[kept])


def seal(boxes: Floats) -> Floats:
    """Return boxes ``(k, 6)`` enlarged by `MARGIN`, so that rounding leaves nothing outside and no gap between them.

    A single box has no gaps and is returned as it is.
    """
    return boxes if len(boxes) == 1 else np.hstack((boxes[:, :3] - MARGIN, boxes[:, 3:] + MARGIN))


def all_covered(polygons: ConvexPolygons, boxes: Floats) -> bool:
    """Tell whether the union of boxes ``(k, 6)`` contains the polygons."""
    return len(outside(polygons, boxes).points) == 0


def enlarged(boxes: Floats, numbers: Sequence[int]) -> Floats:
    """Return some of the boxes, each face moved outwards as far as the union of all boxes contains what is added."""
    grown = boxes[list(numbers)].copy()
    for box in grown:
        for face in range(6):
            outwards = 1.0 if face >= 3 else -1.0
            planes = np.unique(boxes[:, [face % 3, face % 3 + 3]])[:: -1 if face >= 3 else 1]
            for plane in planes[outwards * (planes - box[face]) > 0]:
                added = box.copy()
                added[[face, (face + 3) % 6]] = plane, box[face]
                if _contains(boxes, added):
                    box[face] = plane
                    break
    return np.asarray(grown)


def merged(polygons: ConvexPolygons, boxes: Floats) -> Floats:
    """Return fewer boxes with the same union but for rounding, shrunk; the boxes as they are if there are none.

    Each box is enlarged as far as the union reaches. A box that the others contain then is dropped, small ones first:
    the two halves of a bar that a third box crosses become one bar.
    """
    larger = enlarged(boxes, range(len(boxes)))
    kept = list(np.argsort(volumes(larger), kind="stable"))
    for number in tuple(kept):
        others = [other for other in kept if other != number]
        if others and _contains(larger[others], larger[number]):
            kept = others
    return shrink(polygons, larger[kept]) if len(kept) < len(boxes) else boxes


def _contains(boxes: Floats, box: Floats) -> bool:
    """Tell whether the union of boxes contains a box, but for rounding."""
    inner = np.hstack((np.maximum(boxes[:, :3], box[:3]), np.minimum(boxes[:, 3:], box[3:])))
    meets = (inner[:, :3] < inner[:, 3:]).all(axis=1)
    volume = float(np.prod(box[3:] - box[:3]))
    return bool(meets.any()) and union_volume(inner[meets]) >= volume * (1 - 1e-9)
