"""Shelf packing: place each part in the first row with room, else in a new row, layer or build."""

from collections.abc import Callable
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
    """Enclosing box of an item in its chosen orientation; `lo` and `size` in mm, before the translation."""

    item: int
    rotation: np.ndarray
    lo: np.ndarray
    size: np.ndarray
    value: float


@dataclass(eq=False)
class Row:
    """Row along x: its start in y, its depth in y, and the end of its last box in x, all in mm."""

    y: float
    depth: float
    end: float


@dataclass(eq=False)
class Layer:
    """Adjacent rows at the same height."""

    z: float
    height: float
    rows: list[Row] = field(default_factory=list)


def pack_shelves(
    problem: PackingProblem, *, params: Any, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Place each box in the first row that has room for it (DOI 10.1137/0209062), in time ``O(items * rows)``.

    Every box keeps the clearance from other boxes and from the walls and the top of the build volume.
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
    """Return the first build with room and the least corner of the box in it; a fill problem has one build."""
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
    """Reserve the first position with room in one build and return its least corner; None if there is no room."""
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
    # without stacking there is one layer, as high as the build volume
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
    """Return the greatest coordinates that boxes may have; boxes fit if they exceed the room by the tolerance."""
    return problem.space.size - problem.clearance + CONTACT_TOLERANCE


def _fits_alone(problem: PackingProblem, size: np.ndarray) -> bool:
    first = np.array([problem.clearance, problem.clearance, problem.lift])
    return bool(np.all(first + size <= _room(problem)))


def _box(problem: PackingProblem, number: int, item: Item) -> Box:
    """Return the box of the item in the lowest orientation that fits; the first orientation wins a tie."""
    boxes = []
    for rotation in item.orientations.matrices:
        points = _corners(item) @ rotation.T
        boxes.append(Box(number, rotation, points.min(axis=0), np.ptp(points, axis=0), item.value))
    fitting = [box for box in boxes if _fits_alone(problem, box.size)]
    return min(fitting or boxes, key=lambda box: float(box.size[2].round(9)))


def _corners(item: Item) -> np.ndarray:
    """Return the corners of the boxes of the item, or of the enclosing box of its volume, ``(n, 3)``."""
    volume = item.volume
    boxes = zip(volume.lo, volume.hi, strict=True) if isinstance(volume, Boxes) else [volume.enclosing()]
    return np.array([corner for lo, hi in boxes for corner in product(*zip(lo, hi, strict=True))])


def _order(problem: PackingProblem, params: Any) -> Any:
    """Return the key by which boxes are sorted; the number of the item breaks ties."""
    measures: dict[str, Callable[[Any], tuple[float, ...]]] = {
        "height": lambda box: (box.size[2], box.size[1]),
        "depth": lambda box: (box.size[1], box.size[2]),
        "volume": lambda box: (np.prod(box.size),),
    }
    measure = measures[params.order]
    if problem.objective == "fill":
        return lambda box: (-box.value / np.prod(box.size), box.item)
    return lambda box: (*(-float(each) for each in measure(box)), box.item)
