"""Judge a plate of G-code by the build that was prepared."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode import bed, slicing
from amprep.checks.gcode.expected import ExpectedObject, expected_objects, whole_plate
from amprep.checks.gcode.extents import ExtentFault, LineSizes, find_extent_fault
from amprep.checks.gcode.found import SlicedObject, SlicedPlate
from amprep.checks.gcode.matching import Match, match_objects
from amprep.checks.gcode.sections import compare_layers
from amprep.checks.gcode.shape import find_shape_fault
from amprep.checks.gcode.turned import explain_turn
from amprep.checks.violation import Violation
from amprep.model.build import Build
from amprep.model.counting import counted

NUMBER, POSITION, SIZE, SHAPE = "every object once", "position", "size", "shape"
PROMISES = (NUMBER, POSITION, SIZE, SHAPE, bed.PROMISE, slicing.OWN_SUPPORTS, slicing.LAYER_HEIGHT)
"""Names of all promises, in the order in which they are judged."""
NOT_JUDGED = "not judged"

_THICKEST_FIRST = 3.0
"""First layers (mm) beyond it are percentages of a nozzle."""


@dataclass(frozen=True)
class SlicedVerdict:
    """The verdict on a plate of G-code.

    Attributes
    ----------
    violations
        The broken promises.
    extent
        For each promise, what was judged; it begins with `NOT_JUDGED` if nothing was.
    pairs
        The label of each object of the build that was found, with the object of the G-code.
    """

    violations: tuple[Violation, ...]
    extent: dict[str, str]
    pairs: tuple[tuple[str, SlicedObject], ...]

    @property
    def ok(self) -> bool:
        """Whether every promise holds."""
        return not self.violations


def judge_gcode(build: Build, plate: SlicedPlate, titles: Sequence[str]) -> SlicedVerdict:
    """Return where a slicer's G-code prints something else than a build.

    Parameters
    ----------
    build
        The build.
    plate
        What the G-code prints.
    titles
        What names of objects have behind the labels of parts.
    """
    expected = expected_objects(build, by_part=build.settings.target == "cura")
    labelled = bool(plate.objects)
    if not labelled:
        expected = [whole_plate(expected)]
        plate = _as_one(plate)
    match = match_objects(expected, plate, build.settings.space, titles)
    found = _count_faults(match)
    for ours, theirs in match.pairs:
        found += _object_faults(ours, theirs, plate, match.origin)
    printed = tuple((ours.label, theirs) for ours, theirs in match.pairs)
    rest = [(each.name or "an object", each) for each in match.extra]
    rest += [("the plate", plate.apart)] if labelled else []
    found += bed.check_bed(printed, plate, build.settings.space)
    found += slicing.check_own_supports([*printed, *rest], build, match.origin)
    found += slicing.check_layer_height(printed, build)
    return SlicedVerdict(tuple(found), _extent(build, plate, match, labelled), printed)


def _as_one(plate: SlicedPlate) -> SlicedPlate:
    """Return a plate without labels as one object."""
    return SlicedPlate(
        plate.program, (plate.apart,), "", False, plate.apart, plate.bed, plate.settings, plate.features
    )


def _count_faults(match: Match) -> list[Violation]:
    found = [Violation(NUMBER, each.label, "the slicer did not print it") for each in match.missing]
    return found + [
        Violation(
            NUMBER, each.name or f"object {each.number}", "it is printed, but the build has no such object"
        )
        for each in match.extra
    ]


def _object_faults(
    ours: ExpectedObject, theirs: SlicedObject, plate: SlicedPlate, origin: Floats
) -> list[Violation]:
    """Return what is wrong with an object: first its extent, then its shape."""
    sizes = _sizes_of(theirs)
    z_offset, first = plate.number_setting("z_offset"), _first_layer(theirs, plate)
    fault = find_extent_fault(ours.bounds, _printed_bounds(theirs, first, origin, z_offset), sizes)
    if fault is not None and fault.kind in ("scaled", "height"):
        return [Violation(SIZE, ours.label, fault.words)]
    shift = np.zeros(3) if fault is None else fault.shift
    layers = compare_layers(
        ours.bodies, theirs.body.samples, origin, z_offset + shift[2], max(theirs.body.thickest, first)
    )
    if fault is None or fault.kind == "moved":
        found = [] if fault is None else [Violation(POSITION, ours.label, fault.words)]
        wrong = None if layers is None else find_shape_fault(ours.mesh, layers, sizes.width, shift[:2])
        if wrong is None:
            return found
        words = explain_turn(layers or [], sizes.width) or wrong.words
        return [*found, Violation(SHAPE, ours.label, words)]
    return [_size_fault(ours, fault, explain_turn(layers or [], sizes.width))]


def _size_fault(ours: ExpectedObject, fault: ExtentFault, turn: str) -> Violation:
    return Violation(SHAPE, ours.label, turn) if turn else Violation(SIZE, ours.label, fault.words)


def _sizes_of(theirs: SlicedObject) -> LineSizes:
    widths = [2.0 * float(np.median(each.lines[:, 4])) for each in theirs.body.samples if len(each.lines)]
    layer = theirs.body.thickest or float(theirs.body.low[2])
    return LineSizes(max(widths, default=0.4), layer)


def _first_layer(theirs: SlicedObject, plate: SlicedPlate) -> float:
    """Return the thickness of the first layer, mm."""
    first = plate.number_setting("first_layer_height", "initial_layer_print_height")
    return first if 0.0 < first <= _THICKEST_FIRST else max(theirs.body.thickest, 0.4)


def _printed_bounds(
    theirs: SlicedObject, first: float, origin: Floats, z_offset: float
) -> tuple[Floats, Floats]:
    """Return the extent of an object in build coordinates, from the bottom of its lowest layer."""
    move = np.array([*origin, z_offset])
    low, high = theirs.body.low - move, theirs.body.high - move
    low[2] = max(low[2] - first, 0.0)
    return low, high


def _extent(build: Build, plate: SlicedPlate, match: Match, labelled: bool) -> dict[str, str]:
    """Return what was judged, for each promise."""
    pairs = len(match.pairs)
    unlabelled = f"{NOT_JUDGED}: the objects are not labelled; turn 'Label objects' on"
    layers = sum(len(theirs.body.samples) for _, theirs in match.pairs)
    planned, words = slicing.planned_layer(build)
    return {
        NUMBER: f"{counted(pairs, 'object')} by {plate.labels}" if labelled else unlabelled,
        POSITION: f"extent of {counted(pairs, 'object')} to 0.3 mm; {match.origin_words}",
        SIZE: f"extent of {counted(pairs, 'object')}, heights to a layer",
        SHAPE: f"{counted(layers, 'layer')} compared with sections of parts and supports",
        bed.PROMISE: bed.extent_words(plate),
        slicing.OWN_SUPPORTS: slicing.own_supports_words(plate),
        slicing.LAYER_HEIGHT: f"at most {planned:.3g} mm" if planned else words,
    }
