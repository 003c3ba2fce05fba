"""The form of a mesh reader's answer."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, get_args

import numpy as np

from amprep.checks.packing.motion import motion_fault
from amprep.host.answers.values import are_indices, are_numbers, fault_of_mesh, is_index, is_number, shown
from amprep.model.part import (
    Appearance,
    Freedom,
    Orientations,
    Overrides,
    Part,
    Region,
    RegionKind,
)

_LARGEST_QUANTITY = 100_000


def fault_of_parts(_path: Path, parts: list[Part]) -> str:
    """Return what is wrong with the form of the parts of a file; empty if nothing is."""
    if not parts:
        return "no part; a file without parts must raise InputError"
    return next((fault for part in parts for fault in _faults(part)), "")


def _faults(part: Any) -> Iterator[str]:
    if not isinstance(part.name, str) or not part.name.strip() or not part.name.isprintable():
        yield f"a part with the name {shown(part.name)}, expected a text of one line"
    yield from filter(None, [fault_of_mesh(part.mesh)])
    if not is_number(part.volume_mm3) or not (part.value is None or is_number(part.value)):
        yield "a part whose volume or value is not a finite number"
    if not is_index(part.quantity, _LARGEST_QUANTITY + 1) or part.quantity < 1:
        yield f"a part with the quantity {shown(part.quantity)}, expected 1 to {_LARGEST_QUANTITY}"
    yield from _faults_of_arrays(part)
    yield from _faults_of_texts(part)
    if not isinstance(part.regions, tuple):
        yield "regions that are not a tuple"
        return
    yield from (fault for region in part.regions for fault in _faults_of_region(region, part))


def _faults_of_arrays(part: Any) -> Iterator[str]:
    for name, width in (("boxes", 6), ("positions", 3), ("fixed", 3)):
        values = getattr(part, name)
        if values is not None and not (are_numbers(values, -1, width) and len(values)):
            yield f"a part whose {name} are not finite numbers of shape (k, {width})"
    turns: Any = part.orientations
    if not isinstance(turns, Orientations) or turns.freedom not in get_args(Freedom):
        yield f"a part with the orientations {shown(turns)}"
    elif not len(turns.matrices) or any(motion_fault(m, Orientations("free")) for m in turns.matrices):
        yield "a part with an orientation that is not a rotation"
    looks: Any = part.appearance
    if not isinstance(looks, Appearance):
        yield f"a part with the appearance {shown(looks)}"
        return
    colours = looks.triangle_colours
    if colours is not None and not are_numbers(np.asarray(colours), len(part.mesh.triangles), 3):
        yield "a part whose triangle_colours are not numbers of shape (m, 3)"
    if not all(text is None or isinstance(text, str) for text in (looks.colour, looks.material)):
        yield "a part whose colour or material is not a text"


def _faults_of_texts(part: Any) -> Iterator[str]:
    if not isinstance(part.part_number, str) or not isinstance(part.source, str):
        yield "a part whose part_number or source is not a text"
    if not isinstance(part.notes, tuple) or not all(isinstance(note, str) for note in part.notes):
        yield "a part whose notes are not a tuple of texts"
    if not isinstance(part.metadata, Mapping) or not isinstance(part.overrides, Overrides):
        yield "a part whose metadata or overrides have a wrong type"
    if not isinstance(part.is_solid, bool):
        yield "a part whose is_solid is not a truth value"


def _faults_of_region(region: Any, part: Part) -> Iterator[str]:
    if not isinstance(region, Region) or region.kind not in get_args(RegionKind):
        yield f"the region {shown(region)}"
    elif not isinstance(region.name, str) or (region.triangles is None and region.mesh is None):
        yield "a region without a name, or with neither triangles nor a mesh"
    elif region.triangles is not None and not are_indices(region.triangles, len(part.mesh.triangles)):
        yield "a region with a triangle that the part does not have"
    elif region.mesh is not None:
        yield from filter(None, [fault_of_mesh(region.mesh)])
        if region.triangles is not None and len(region.triangles) != len(region.mesh.triangles):
            yield "a painted region whose triangles and mesh differ in length"
