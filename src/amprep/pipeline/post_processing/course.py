"""Compare a file of G-code with the build that it was made from, and write what was found."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.checks.gcode.judge import NUMBER, judge_gcode
from amprep.checks.violation import Violation
from amprep.files import replacing
from amprep.model.build import Build
from amprep.pipeline.post_processing.comments import write_comments
from amprep.pipeline.post_processing.find_build import FoundBuild, find_build
from amprep.report.gcode import GcodeRecord, gcode_json, summary_lines
from amprep.slicers.environment import Destination, destination_of
from amprep.slicers.gcode.read import GcodeHead, read_gcode, read_head

_MOST_LAYERS, _LEAST_LAYERS = 24, 4
"""Numbers of layers of each object that are compared with sections."""
_LAYERS_OF_ALL = 600


def check_gcode(
    gcode: Path, *, build: Path | None = None, folder: Path | None = None, environment: Mapping[str, str]
) -> GcodeRecord:
    """Judge a file of G-code by the build that it was made from; nothing is written.

    Parameters
    ----------
    gcode
        The file.
    build, folder
        The build file, or where to search it; by default beside the G-code and beside the finished file.
    environment
        Variables in which a slicer states where the finished file goes.

    Raises
    ------
    InputError
        If the G-code or the build file cannot be read.
    """
    head = read_head(gcode)
    where = destination_of(gcode, environment)
    beside = [path.parent for path in (where.output, gcode) if path is not None]
    found = find_build(head, where.name, build=build, folder=folder, beside=beside)
    record = GcodeRecord(where.name, where.host, found.path, found.words)
    return record if found.path is None else _judged(record, gcode, head, found)


def write_findings(record: GcodeRecord, gcode: Path, environment: Mapping[str, str]) -> Path | None:
    """Write the summary into the G-code, and the JSON beside the finished file.

    Returns
    -------
    The path of the JSON; None if the G-code goes to a print server, where nothing can be put beside it.

    Raises
    ------
    AmprepError
        If a file cannot be written.
    """
    where = destination_of(gcode, environment)
    lines = [*summary_lines(record), *_destination_words(where)]
    if where.output is None:
        write_comments(gcode, lines)
        return None
    path = where.output.with_name(f"{where.output.stem}.amprep.json")
    with replacing(path) as temporary:  # if the G-code cannot be written, the JSON does not appear
        temporary.write_text(json.dumps(gcode_json(record), indent=2) + "\n", encoding="utf-8")
        write_comments(gcode, lines)
    return path


def _judged(record: GcodeRecord, gcode: Path, head: GcodeHead, found: FoundBuild) -> GcodeRecord:
    from amprep.threemf import read_build

    path: Any = found.path
    build = read_build(path)
    name = build.settings.build_id
    plate = read_gcode(gcode, head, sample_heights(build))
    titles = [f"{name} {found.identifier}".strip(), name]
    verdict = judge_gcode(build, plate, titles)
    if found.is_other:
        message = f"the objects of the G-code come from another build than {path.name}"
        verdict = replace(verdict, violations=(Violation(NUMBER, name, message), *verdict.violations))
    return replace(record, build_title=titles[0], plate=plate, verdict=verdict)


def sample_heights(build: Build) -> Floats:
    """Return the heights (mm) in whose layers shapes are compared, fewer where there are many objects.

    They are closer to each other near the plate, so that low objects beside high ones have several, too.
    """
    objects = max(len(build.parts), 1)
    count = min(max(_LAYERS_OF_ALL // objects, _LEAST_LAYERS), _MOST_LAYERS)
    top = max((each.mesh.bounds[1][2] for each in build.parts), default=1.0)
    heights: Floats = 0.01 + 0.999 * float(top) * np.linspace(0.0, 1.0, count) ** 2
    return heights


def _destination_words(where: Destination) -> list[str]:
    if where.output is not None:
        return []
    return [f"host: the G-code goes to {where.host}, so no JSON is written beside it"]
