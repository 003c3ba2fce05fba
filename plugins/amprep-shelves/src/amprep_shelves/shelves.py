"""Shelf packing: the first row with room, else a new row, a new layer, a new build."""

from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from amprep.model import (
    CONTACT_TOLERANCE,
    Boxes,
    Item,
    Packing,
    PackingProblem,
    Placement,
    Progress,
    Stop,
    Unplaced,
)


@dataclass(frozen=True, eq=False)
class Box:
    """An item's enclosing box in the orientation chosen for it; corners in mm, before any translation."""

    item: int
    rotation: np.ndarray
    lo: np.ndarray
    size: np.ndarray
    value: float


@dataclass(eq=False)
class Row:
    """A row along x: where it starts in y, how deep it is, how far it is filled."""

    y: float
    depth: float
    end: float


@dataclass(eq=False)
class Layer:
    """Rows beside each other at one height."""

    z: float
    height: float
    rows: list[Row] = field(default_factory=list)


def pack_shelves(
    problem: PackingProblem, *, params: Any, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Place the boxes one after the other, each where the first row has room (DOI 10.1137/0209062).

    Every box keeps the clearance from the next one, the walls and the lid. Runs in time ``O(items * rows)``.
    """
    boxes = sorted(
        (_box(problem, number, item) for number, item in enumerate(problem.items)),
        key=_order(problem, params),
    )
    builds: list[list[Layer]] = []
    placements: list[list[Placement]] = []
    unplaced: list[Unplaced] = []
    for count, box in enumerate(boxes):
        progress(count / len(boxes), "packing")
        if stop():
            unplaced.append(Unplaced(box.item, "out of time"))
            continue
        if not _fits_alone(problem, box.size):
            unplaced.append(Unplaced(box.item, "too large"))
            continue
        found = _first_place(problem, builds, box)
        if found is None:
            unplaced.append(Unplaced(box.item, "no room left"))
            continue
        build, corner = found
        if build == len(placements):
            placements.append([])
        placements[build].append(Placement(box.item, box.rotation, corner - box.lo))
    reason = stop.reason if any(entry.reason == "out of time" for entry in unplaced) else "finished"
    return Packing(tuple(map(tuple, placements)), tuple(unplaced), stop_reason=reason)


def _first_place(
    problem: PackingProblem, builds: list[list[Layer]], box: Box
) -> tuple[int, np.ndarray] | None:
    """Return the build and the least corner of the first place with room; a fill problem has one build."""
    for number, layers in enumerate(builds):
        corner = _place_in(problem, layers, box)
        if corner is not None:
            return number, corner
    if problem.objective == "fill" and builds:
        return None
    builds.append([])
    corner = _place_in(problem, builds[-1], box)
    return None if corner is None else (len(builds) - 1, corner)


def _place_in(problem: PackingProblem, layers: list[Layer], box: Box) -> np.ndarray | None:
    """Return the least corner of the first place in one build, and reserve it; None when there is none."""
    gap, room = problem.clearance, _room(problem)
    for layer in layers:
        if box.size[2] <= layer.height:
            corner = _place_in_layer(gap, room, layer, box)
            if corner is not None:
                return corner
    z = layers[-1].z + layers[-1].height + gap if layers else problem.lift
    allowed = problem.stacking or not layers
    if not allowed or z + box.size[2] > room[2]:
        return None
    # parts beside each other share one layer: it is as high as the build volume
    layers.append(Layer(z, box.size[2] if problem.stacking else room[2] - z))
    return _place_in_layer(gap, room, layers[-1], box)


def _place_in_layer(gap: float, room: np.ndarray, layer: Layer, box: Box) -> np.ndarray | None:
    for row in layer.rows:
        if box.size[1] <= row.depth and row.end + gap + box.size[0] <= room[0]:
            return _reserve(row, gap, layer.z, box)
    y = layer.rows[-1].y + layer.rows[-1].depth + gap if layer.rows else gap
    if y + box.size[1] > room[1]:
        return None
    layer.rows.append(Row(y, box.size[1], end=0.0))
    return _reserve(layer.rows[-1], gap, layer.z, box)


def _reserve(row: Row, gap: float, z: float, box: Box) -> np.ndarray:
    corner = np.array([row.end + gap, row.y, z])
    row.end = corner[0] + box.size[0]
    return corner


def _room(problem: PackingProblem) -> np.ndarray:
    """Return how far boxes may reach; what is too large by no more than the tolerance fits."""
    return problem.space.size - problem.clearance + CONTACT_TOLERANCE


def _fits_alone(problem: PackingProblem, size: np.ndarray) -> bool:
    first = np.array([problem.clearance, problem.clearance, problem.lift])
    return bool(np.all(first + size <= _room(problem)))


def _box(problem: PackingProblem, number: int, item: Item) -> Box:
    """Return the item's box in the lowest orientation that fits; of equals, the one preferred by the part."""
    boxes = []
    for rotation in item.orientations.matrices:
        points = _corners(item) @ rotation.T
        boxes.append(Box(number, rotation, points.min(axis=0), np.ptp(points, axis=0), item.value))
    fitting = [box for box in boxes if _fits_alone(problem, box.size)]
    return min(fitting or boxes, key=lambda box: float(box.size[2].round(9)))


def _corners(item: Item) -> np.ndarray:
    """Return the corners of the item's boxes, or of the box around its volume, ``(n, 3)``."""
    volume = item.volume
    boxes = zip(volume.lo, volume.hi, strict=True) if isinstance(volume, Boxes) else [volume.enclosing()]
    return np.array([corner for lo, hi in boxes for corner in product(*zip(lo, hi, strict=True))])


def _order(problem: PackingProblem, params: Any) -> Any:
    """Return the key by which boxes are sorted; the item's number breaks ties."""
    measures = {
        "height": lambda box: (box.size[2], box.size[1]),
        "depth": lambda box: (box.size[1], box.size[2]),
        "volume": lambda box: (np.prod(box.size),),
    }
    measure = measures[params.order]
    if problem.objective == "fill":
        return lambda box: (-box.value / np.prod(box.size), box.item)
    return lambda box: (*(-float(each) for each in measure(box)), box.item)
