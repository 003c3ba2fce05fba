"""The form of a volume maker's answer."""

from collections.abc import Iterator
from typing import Any

from amprep.checks.packing.motion import motion_fault
from amprep.host.answers.values import are_numbers, fault_of_mesh, is_number, shown
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid, TurnedVolume
from amprep.model.part import Orientations, Part


def fault_of_volume(_part: Part, made: BoundingVolume | TurnedVolume) -> str:
    """Return what is wrong with the form of a bounding volume; empty if nothing is."""
    return next(_faults(made), "")


def _faults(made: Any) -> Iterator[str]:
    if not isinstance(made, TurnedVolume):
        yield from _faults_of_volume(made)
        return
    yield from _faults_of_volume(made.volume)
    if not are_numbers(made.rotation, 3, 3) or motion_fault(made.rotation, Orientations("free")):
        yield "a turned volume whose matrix is not a rotation"
    for name in ("bound", "gap"):
        value = getattr(made, name)
        if value is not None and not is_number(value):
            yield f"a turned volume with the {name} {shown(value)}, expected a finite number or None"


def _faults_of_volume(volume: Any) -> Iterator[str]:
    if isinstance(volume, Boxes):
        yield from _faults_of_boxes(volume)
    elif isinstance(volume, ConvexPieces):
        if not isinstance(volume.pieces, tuple) or not volume.pieces:
            yield "convex pieces that are not a tuple of at least one mesh"
        else:
            yield from filter(None, map(fault_of_mesh, volume.pieces))
    elif isinstance(volume, Solid):
        yield from filter(None, [fault_of_mesh(volume.mesh)])
    else:
        yield f"a turned volume of {shown(volume)}, expected Boxes, ConvexPieces or Solid"


def _faults_of_boxes(boxes: Boxes) -> Iterator[str]:
    count = len(boxes.lo)
    if not count or not are_numbers(boxes.lo, count, 3) or not are_numbers(boxes.hi, count, 3):
        yield "boxes without two finite corners each"
    elif (boxes.lo > boxes.hi).any():
        yield "a box whose least corner is above its greatest one"
