"""The verdict on G-code in words and as JSON."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from amprep import __version__
from amprep.arrays import Floats
from amprep.checks.gcode import bed, judge, slicing
from amprep.checks.gcode.found import SlicedObject, SlicedPlate
from amprep.checks.gcode.judge import NOT_JUDGED, PROMISES, SlicedVerdict
from amprep.model.counting import counted
from amprep.report.json_values import violations_json

_REMEDIES = {
    judge.NUMBER: "open the build file again and delete, copy or split nothing",
    judge.POSITION: "open the build file again, and let the slicer neither arrange objects nor drop them onto the bed",
    judge.SIZE: "open the build file again and scale nothing",
    judge.SHAPE: "open the build file again, and turn, mirror or cut nothing",
    bed.PROMISE: "choose the printer for which the build was prepared",
    slicing.OWN_SUPPORTS: "turn off the slicer's own supports, and in Cura 'Drop Down Support Mesh'",
    slicing.LAYER_HEIGHT: "choose thinner layers in the slicer, or prepare the build for these",
}
"""What the user of a slicer can do about a broken promise."""


@dataclass(frozen=True, eq=False)
class GcodeRecord:
    """A file of G-code, the build that it was made from, and the verdict.

    Attributes
    ----------
    name
        Name of the finished file.
    host
        Where the slicer sends it; ``File`` for a file, "" if no slicer runs the script.
    build_file, build_words
        The build file, None if none was found; by what it was found, or why it was not.
    build_title
        Name and identifier of the build.
    plate, verdict
        What the G-code prints, and what is wrong with it; None without a build.
    """

    name: str
    host: str
    build_file: Path | None
    build_words: str
    build_title: str = ""
    plate: SlicedPlate | None = None
    verdict: SlicedVerdict | None = None

    @property
    def ok(self) -> bool:
        """Whether the G-code was judged and every promise holds."""
        return self.verdict is not None and self.verdict.ok


def summary_lines(record: GcodeRecord) -> list[str]:
    """Return the record in a few lines of text."""
    if record.verdict is None or record.build_file is None:
        return [f"{__version__}: not compared with a build: {record.build_words}"]
    verdict = record.verdict
    faults = len(verdict.violations)
    head = (
        "prints what was prepared"
        if verdict.ok
        else f"does not print what was prepared: {counted(faults, 'fault')}"
    )
    lines = [
        f"{__version__}: {head}",
        f"build: {record.build_title}, file {record.build_file.name}, found {record.build_words}",
    ]
    lines += [f"fault: {violation}" for violation in verdict.violations]
    broken = {violation.promise for violation in verdict.violations}
    for promise in PROMISES:
        words = verdict.extent[promise]
        if words.startswith(NOT_JUDGED):
            lines.append(f"{promise}: {words}")
        else:
            lines.append(f"{promise}: {'broken' if promise in broken else 'holds'}; {words}")
    return lines + [f"object {label}: {_object_words(each)}" for label, each in verdict.pairs]


def refusal_lines(record: GcodeRecord) -> list[str]:
    """Return why the G-code is refused, for a dialogue of the slicer."""
    if record.verdict is None:
        return [f"{record.name} was not compared with a build: {record.build_words}"]
    lines = [f"{record.name} does not print what was prepared ({record.build_title}):"]
    broken = dict.fromkeys(violation.promise for violation in record.verdict.violations)
    advice = [f"remedy: {_REMEDIES[promise]}" for promise in broken if promise in _REMEDIES]
    return lines + [str(violation) for violation in record.verdict.violations] + advice


def gcode_json(record: GcodeRecord) -> dict[str, Any]:
    """Return the record as JSON values."""
    plate, verdict = record.plate, record.verdict
    return {
        "amprep": __version__,
        "file": record.name,
        "host": record.host,
        "build": {
            "file": None if record.build_file is None else str(record.build_file),
            "name": record.build_title,
            "found": record.build_words,
        },
        "ok": record.ok,
        "judged": verdict is not None,
        "slicer": "" if plate is None else plate.program,
        "violations": [] if verdict is None else violations_json(verdict.violations),
        "extent": {} if verdict is None else verdict.extent,
        "objects": [] if verdict is None else [_object_json(*pair) for pair in verdict.pairs],
    }


def _object_json(label: str, printed: SlicedObject) -> dict[str, Any]:
    body = printed.body
    return {
        "part": label,
        "name": printed.name,
        "low_mm": _rounded(body.low),
        "high_mm": _rounded(body.high),
        "layers": body.layers,
        "thickest_layer_mm": round(body.thickest, 4),
        "line_mm": round(body.length, 1),
        "slicer_supports_mm": round(printed.supports.length, 1),
    }


def _object_words(printed: SlicedObject) -> str:
    body = printed.body
    size = " x ".join(f"{value:.1f}" for value in (body.high - body.low * [1, 1, 0]).tolist())
    corner = ", ".join(f"{value:.2f}" for value in body.low[:2].tolist())
    return f"{size} mm from ({corner}), {counted(body.layers, 'layer')}"


def _rounded(values: Floats) -> list[float]:
    return [float(value) for value in np.round(values, 4)]
