"""Apply the ``[[part]]`` entries of a job to the parts that were read."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import JobError, nearest_hint
from amprep.job.settings.job import Job
from amprep.job.settings.packing import as_names
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.rules import RuleSettings
from amprep.model.counting import counted
from amprep.model.orientation import OrientationRules
from amprep.model.part import Part
from amprep.model.rotations import ORIENT, parse_rotations
from amprep.overhangs.conditions import colours_of, is_named


def apply_part_settings(parts: Sequence[Part], job: Job) -> list[Part]:
    """Return the parts with the settings of their ``[[part]]`` entries; later entries take precedence.

    An entry names parts by their file, by their name, or by both.

    Raises
    ------
    JobError
        When an entry, or the condition `part` of a ``[[rule]]`` entry, names no part, or its condition `colour` no
        colour and no region of these parts; the message suggests a similar name.
    """
    for number, rule in enumerate(job.rules, start=1):
        _check_rule(rule, parts, f"{job.source}: [[rule]] {number}")
    result = [_with_rotations(part, job.packing.rotations) for part in parts]
    for number, entry in enumerate(job.parts, start=1):
        chosen = [index for index, part in enumerate(parts) if names_part(entry, part, job)]
        if not chosen:
            raise JobError(f"{job.source}: [[part]] {number}: {_unmatched(entry, parts)}")
        for index in chosen:
            result[index] = _with_settings(result[index], entry)
    return result


def _check_rule(rule: RuleSettings, parts: Sequence[Part], where: str) -> None:
    """Raise `JobError` if no part has the name and the colour that a rule asks for."""
    named = [part for part in parts if rule.part is None or is_named(part, rule.part)]
    if rule.part is not None and not named:
        near = nearest_hint(rule.part, [part.name for part in parts])
        raise JobError(f"{where}: no part is called {rule.part!r}{near}")
    if rule.colour is None:
        return
    known = frozenset().union(*(colours_of(part) for part in named))
    if (rule.paint or rule.colour) not in known:
        near = nearest_hint(rule.paint or rule.colour, known) or " (no part has colours or regions)"
        raise JobError(f"{where}: no part has the colour or the region {rule.colour!r}{near}")


def names_part(entry: PartSettings, part: Part, job: Job) -> bool:
    """Tell whether an entry of the job names the part."""
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
    """Return the fixed positions of copies.

    Raises
    ------
    JobError
        When there are more fixed positions than copies.
    """
    quantity = entry.quantity or part.quantity
    if len(entry.fixed) > quantity:
        raise JobError(
            f"part {part.name!r}: fixed has {counted(len(entry.fixed), 'position')}, but the quantity is {quantity}; "
            "raise quantity"
        )
    return frozen(entry.fixed, np.float64, 3) if entry.fixed else part.fixed


def _volumes(part: Part, entry: PartSettings) -> tuple[str, ...] | None:
    """Return the names of the volume makers for the part; boxes in the entry choose the maker that takes them."""
    if entry.boxes is not None:
        return ("boxes",)
    return part.overrides.volumes if entry.volumes is None else as_names(entry.volumes)


def _with_rotations(part: Part, rotations: str | None) -> Part:
    """Return a part that states no rotations with those of the job."""
    if rotations is None or part.orientations.freedom != "list" or len(part.orientations.matrices) > 1:
        return part
    if rotations == ORIENT:
        return replace(part, orient=OrientationRules())
    return replace(part, orientations=parse_rotations(rotations))


def _orient(part: Part, entry: PartSettings) -> OrientationRules | None:
    """Return what restricts the search for orientations; an entry with other rotations ends the search."""
    if entry.rotations is not None and entry.rotations != ORIENT:
        return None
    asked = entry.rotations == ORIENT or part.orient is not None
    return entry.orientation_rules if asked else None


def _with_settings(part: Part, entry: PartSettings) -> Part:
    angle, margin = entry.overhang_angle_deg, entry.territory_margin_mm
    overrides = replace(
        part.overrides,
        overhang_angle_deg=part.overrides.overhang_angle_deg if angle is None else angle,
        territory_margin_mm=part.overrides.territory_margin_mm if margin is None else margin,
        supports=part.overrides.supports if entry.supports is None else entry.supports,
        volumes=_volumes(part, entry),
    )
    return replace(
        part,
        quantity=entry.quantity or part.quantity,
        value=part.value if entry.value is None else entry.value,
        orientations=entry.orientations or part.orientations,
        boxes=part.boxes if entry.boxes is None else entry.box_array,
        fixed=_fixed(part, entry),
        orient=_orient(part, entry),
        overrides=overrides,
    )
