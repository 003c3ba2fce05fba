"""Packing problems of single boxes."""

import numpy as np

from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem


def boxes_problem(sizes, room=(10, 10, 10), *, values=None, orientations=None, **rules):
    """Return a problem of one box per size; values default to volumes, and one number for `room` means a cube."""
    values = [float(np.prod(size)) for size in sizes] if values is None else values
    turns = orientations or Orientations()
    items = tuple(
        Item(i, 0, Boxes(np.zeros((1, 3)), np.array([size], float)), float(value), turns)
        for i, (size, value) in enumerate(zip(sizes, values, strict=True))
    )
    space = room if isinstance(room, BuildVolume) else BuildVolume(np.broadcast_to(np.array(room, float), 3))
    return PackingProblem(items, space, **rules)


def cut(rng, size, count):
    """Return boxes that fill a container exactly: the largest one is cut in two until there are `count`."""
    boxes = [list(size)]
    while len(boxes) < count:
        box = boxes.pop(int(np.argmax([np.prod(b) for b in boxes])))
        axis = int(np.argmax(box))
        at = int(rng.integers(1, box[axis]))
        boxes += [[*box[:axis], at, *box[axis + 1 :]], [*box[:axis], box[axis] - at, *box[axis + 1 :]]]
    return boxes
