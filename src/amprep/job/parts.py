"""Applies what the job says about single parts to the parts that were read."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import JobError, nearest_hint
from amprep.job.settings.job import Job
from amprep.job.settings.parts import PartSettings
from amprep.model.part import Part


def apply_part_settings(parts: Sequence[Part], job: Job) -> list[Part]:
    """Return the parts with the settings of every ``[[part]]`` entry that names them; later entries win.

    An entry names parts by the file they came from, by their name, or by both.

    Raises
    ------
    JobError
        When an entry names no part, with the nearest known file or name.
    """
    result = list(parts)
    for number, entry in enumerate(job.parts, start=1):
        chosen = [index for index, part in enumerate(parts) if names_part(entry, part, job)]
        if not chosen:
            raise JobError(f"{job.source}: [[part]] {number}: {_unmatched(entry, parts)}")
        for index in chosen:
            result[index] = _with_settings(result[index], entry)
    return result


def names_part(entry: PartSettings, part: Part, job: Job) -> bool:
    """Tell whether an entry of the job is about the part."""
    same_name = entry.name is None or part.name == entry.name
    return same_name and (entry.file is None or _same_file(entry.file, part.source, job.folder))


def _same_file(file: str, source: str, folder: Path | None) -> bool:
    return bool(source) and ((folder or Path()) / file).resolve() == Path(source).resolve()


def _unmatched(entry: PartSettings, parts: Sequence[Part]) -> str:
    if entry.name is not None:
        return f"no part is called {entry.name!r}{nearest_hint(entry.name, [part.name for part in parts])}"
    file = str(entry.file)
    return f"no part comes from {file!r}{nearest_hint(file, {Path(part.source).name for part in parts})}"


def _fixed(part: Part, entry: PartSettings) -> Floats | None:
    """Return where the first copies stand already.

    Raises
    ------
    JobError
        When more copies are fixed than wanted.
    """
    quantity = entry.quantity or part.quantity
    if len(entry.fixed) > quantity:
        raise JobError(
            f"part {part.name!r}: fixed names {len(entry.fixed)} places, but only {quantity} copies are wanted; "
            "raise quantity"
        )
    return frozen(entry.fixed, np.float64, 3) if entry.fixed else part.fixed


def _with_settings(part: Part, entry: PartSettings) -> Part:
    angle = entry.overhang_angle_deg
    overrides = replace(
        part.overrides,
        overhang_angle_deg=part.overrides.overhang_angle_deg if angle is None else angle,
        supports=part.overrides.supports if entry.supports is None else entry.supports,
    )
    return replace(
        part,
        quantity=entry.quantity or part.quantity,
        value=part.value if entry.value is None else entry.value,
        orientations=entry.orientations or part.orientations,
        boxes=part.boxes if entry.boxes is None else entry.box_array,
        fixed=_fixed(part, entry),
        overrides=overrides,
    )
