"""Make a job from a job file or from inputs alone, and check that every key is known, typed and within its bounds."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeVar

from amprep.errors import JobError, nearest_hint
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.job import InputSpec, Job, ReadingSettings
from amprep.job.settings.packing import PackingSettings
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.rules import RuleSettings
from amprep.job.settings.supports import SupportSettings
from amprep.materials.catalogue import DEFAULT_MATERIALS, find_material
from amprep.materials.profile import MaterialProfile
from amprep.model.build import Target
from amprep.printers.catalogue import DEFAULT_PRINTER, Printer, find_printer, printer_from_table
from amprep.typed import convert, make
from amprep.validation import read_table

T = TypeVar("T")

_LONGEST_NAME = 100
"""Largest number of characters in the name of a job."""

TERRITORY_DEFAULTS = {"territory": "own", "drift_ratio": 1 / 3, "drift_mm": 15.0}
KEYS = (
    "name",
    "printer",
    "material",
    "seed",
    "target",
    "inputs",
    "labels",
    "reading",
    "packing",
    "supports",
    "cells",
    "part",
    "rule",
)


def job_of(inputs: Sequence[str | Path], source: str = "command line") -> Job:
    """Return the job of one job file (.toml), or a job of default settings that prints the inputs.

    Parameters
    ----------
    inputs
        The job file, or files and folders, also as ``NAME:quantity``.
    source
        Name of a job without a file in messages.

    Raises
    ------
    JobError
        When a job file is not the only input, and as `load_job` and `job_from_inputs` do.
    """
    job_files = [str(each) for each in inputs if str(each).lower().endswith(".toml")]
    if not job_files:
        return job_from_inputs(inputs, source)
    if len(inputs) > 1:
        raise JobError(
            f"a job file must be the only input, got {len(inputs)}; list the others under inputs = [...] in "
            f"{job_files[0]}"
        )
    return load_job(Path(job_files[0]))


def load_job(path: Path) -> Job:
    """Return the job of a job file; relative paths start at the folder of the file.

    Raises
    ------
    JobError
        When a key is unknown or a value has a wrong type or is out of bounds (the message names the file and the
        key), or when there is nothing to print.
    """
    table = read_table(path, "job")
    return _with_inputs(make_job(table, name=path.stem, folder=path.resolve().parent, source=str(path)))


def job_from_inputs(inputs: Sequence[str | Path], source: str = "command line") -> Job:
    """Return a job of default settings that prints the inputs: files and folders, also as ``NAME:quantity``.

    Messages name it by `source`.

    Raises
    ------
    JobError
        When there are no inputs, or a quantity is out of bounds.
    """
    table = {"inputs": [str(each) for each in inputs]}
    return _with_inputs(make_job(table, name=_name_of(inputs), folder=None, source=source))


def _name_of(inputs: Sequence[str | Path]) -> str:
    """Return the name of a job without a file: the only input, or else the folder that contains all of them."""
    paths = [parse_input(str(each), "inputs").path.resolve() for each in inputs]
    if len(paths) == 1:
        return (paths[0].name if paths[0].is_dir() else paths[0].stem) or "job"
    try:
        return Path(os.path.commonpath([path.parent for path in paths])).name or "job"
    except ValueError:  # no path, or paths on different drives
        return "job"


def make_job(table: Mapping[str, Any], *, name: str, folder: Path | None, source: str) -> Job:
    """Return the job that a table of plain values describes.

    Parameters
    ----------
    table
        Keys and values as in a job file.
    name
        Name of the job if the table states none; the output files are named after it.
    folder
        Folder where relative paths start; None for the current folder.
    source
        Name of the job in messages.

    Raises
    ------
    JobError
        When a key or a value is wrong; the message names `source` and the key.
    """
    for key in table:
        if key not in KEYS:
            raise JobError(f"{source}: unknown key {key!r}{_hint(key)}")
    printer = _printer(table.get("printer", DEFAULT_PRINTER), folder, source)
    material = _material(table, printer, folder, source)
    packing = _section(PackingSettings, table, "packing", source, **printer.packing_defaults)
    parts = tuple(
        make(PartSettings, _is_table(entry, f"{source}: [[part]] {number}"), f"{source}: [[part]] {number}")
        for number, entry in enumerate(_entries(table, "part", source), 1)
    )
    supports = _section(
        SupportSettings, table, "supports", source, **_support_defaults(table, printer, material, packing)
    )
    cells = _cells(table, folder, source)
    return Job(
        name=_stated_name(table, source) or name,
        inputs=_inputs(table, parts, folder, source),
        labels=_labels(table, folder, source),
        printer=printer,
        folder=folder,
        material=material,
        seed=_seed(table, source),
        target=convert(table.get("target", "generic"), Target, f"{source}: target"),
        reading=_section(ReadingSettings, table, "reading", source),
        packing=packing,
        supports=supports,
        cells=cells,
        parts=parts,
        rules=_rules(table, supports, cells, folder, source),
        source=source,
        table=table,
    )


def _stated_name(table: Mapping[str, Any], source: str) -> str:
    """Return the key ``name``, which must be usable in names of files; empty if it is not there."""
    name: str = convert(table.get("name", ""), str, f"{source}: name")
    usable = len(name) <= _LONGEST_NAME and name.isprintable() and not name.startswith(".")
    if not usable or set(name) & set('/\\:*?"<>|') or ("name" in table and not name.strip()):
        raise JobError(
            f"{source}: name must have 1 to {_LONGEST_NAME} characters that names of files may have, got {name[:80]!r}"
        )
    return name


def parse_input(text: str, where: str) -> InputSpec:
    """Read ``path`` or ``path:quantity``; an existing file whose name ends in ``:number`` is a path.

    Raises
    ------
    JobError
        When the quantity is out of bounds.
    """
    if not text or "\0" in text:
        raise JobError(f"{where}: expected the path of a file or folder, got {text!r}")
    path, colon, count = text.rpartition(":")
    if not (colon and path and count.isascii() and count.isdecimal()) or Path(text).exists():
        return InputSpec(Path(text))
    try:
        return InputSpec(Path(path), int(count[:20]))
    except ValueError as error:
        raise JobError(f"{where}: {text!r}: {error}") from error


def _section(cls: type[T], table: Mapping[str, Any], key: str, source: str, **defaults: Any) -> T:
    where = f"{source}: [{key}]"
    return make(cls, {**defaults, **_is_table(table.get(key, {}), where)}, where)


def _cells(table: Mapping[str, Any], folder: Path | None, source: str) -> CellSettings:
    """Return the cell settings, with the path of the file that declares the cell made absolute."""
    settings = _section(CellSettings, table, "cells", source)
    return replace(settings, strategy=_cell_file(settings.strategy, folder, f"{source}: [cells]: strategy"))


def _cell_file(cell: str, folder: Path | None, where: str) -> str:
    """Return the absolute path of the file that declares a cell; the name of a cell stays as it is."""
    file = CellSettings(strategy=cell).file
    if file is None:
        return cell
    path = (folder or Path()) / file
    if not path.is_file():
        raise JobError(f"{where}: no file at {path}")
    return str(path.resolve())


def _labels(table: Mapping[str, Any], folder: Path | None, source: str) -> Path | None:
    """Return the path of the list of labels; None without one."""
    if "labels" not in table:
        return None
    name: str = convert(table["labels"], str, f"{source}: labels")
    path = (folder or Path()) / name
    if "\0" in name or not path.is_file():
        raise JobError(f"{source}: labels: no file at {str(path)!r}")
    return path


def _rules(
    table: Mapping[str, Any], supports: SupportSettings, cells: CellSettings, folder: Path | None, source: str
) -> tuple[RuleSettings, ...]:
    """Return the settings of overhang regions, each of which must fit the settings of the job."""
    rules = []
    for number, entry in enumerate(_entries(table, "rule", source), 1):
        where = f"{source}: [[rule]] {number}"
        rule = make(RuleSettings, _is_table(entry, where), where)
        if rule.cell is not None:
            rule = replace(rule, cell=_cell_file(rule.cell, folder, f"{where}: cell"))
        try:
            rule.cells(cells), rule.supports(supports)
            rule.require_kinds(supports.rules)
        except ValueError as error:
            raise JobError(f"{where}: {error}") from error
        rules.append(rule)
    return tuple(rules)


def _entries(table: Mapping[str, Any], key: str, source: str) -> tuple[Any, ...]:
    """Return the entries of a list of tables; one table is no list."""
    value, where = table.get(key, []), f"{source}: {key}"
    if isinstance(value, Mapping):
        raise JobError(
            f"{where}: expected entries [[{key}]], got one table; write [[{key}]] in place of [{key}]"
        )
    return tuple(convert(value, tuple[Any, ...], where))


def _is_table(value: Any, where: str) -> Mapping[str, Any]:
    checked: Mapping[str, Any] = convert(value, Mapping[str, Any], where)
    return checked


def _support_defaults(
    table: Mapping[str, Any], printer: Printer, material: MaterialProfile, packing: PackingSettings
) -> dict[str, Any]:
    """Return the defaults that depend on the printer, on the material, on the clearance, and on the overhang angle."""
    section, defaults = table.get("supports", {}), material.support_defaults
    angle = section.get("overhang_angle_deg") if isinstance(section, Mapping) else None
    number = float(angle) if isinstance(angle, int | float) else material.overhang_angle_deg
    return {
        **TERRITORY_DEFAULTS,
        "territory_margin_mm": packing.clearance_mm / 2,
        **defaults,
        "enabled": printer.needs_supports,
        "strut_angle_deg": min(max(number, 10.0), 80.0),
    }


def _material(
    table: Mapping[str, Any], printer: Printer, folder: Path | None, source: str
) -> MaterialProfile:
    default = DEFAULT_MATERIALS[printer.technology]
    name: str = convert(table.get("material", default), str, f"{source}: material")
    try:
        return find_material(name, folder)
    except JobError as error:
        raise JobError(f"{source}: material: {error}") from error


def _printer(value: Any, folder: Path | None, source: str) -> Printer:
    if isinstance(value, Mapping):
        return printer_from_table(value, f"{source}: [printer]", "own printer")
    name: str = convert(value, str, f"{source}: printer")
    try:
        return find_printer(name, folder)
    except JobError as error:
        raise JobError(f"{source}: printer: {error}") from error


def _seed(table: Mapping[str, Any], source: str) -> int:
    seed: int = convert(table.get("seed", 0), int, f"{source}: seed")
    if not 0 <= seed < 2**63:
        raise JobError(f"{source}: seed must be between 0 and 2**63 - 1, got {seed}")
    return seed


def _inputs(
    table: Mapping[str, Any], parts: Sequence[PartSettings], folder: Path | None, source: str
) -> tuple[InputSpec, ...]:
    """Return the inputs, followed by the files of those ``[[part]]`` entries that are in no input."""
    base = folder or Path()
    where = f"{source}: inputs"
    given = [
        parse_input(text, where) if folder is None else _within(base, parse_input(str(base / text), where))
        for text in convert(table.get("inputs", []), tuple[str, ...], where)
    ]
    for part in parts:
        path = base / part.file if part.file else None
        if path is not None and not any(_covers(entry.path, path) for entry in given):
            given.append(InputSpec(path))
    return tuple(given)


def _with_inputs(job: Job) -> Job:
    if not job.inputs:
        raise JobError(
            f"{job.source}: nothing to print; expected inputs = [...] or [[part]] entries with a file"
        )
    return job


def _within(base: Path, entry: InputSpec) -> InputSpec:
    return InputSpec(base / entry.path, entry.quantity)


def _covers(entry: Path, path: Path) -> bool:
    entry, path = entry.resolve(), path.resolve()
    return entry == path or entry in path.parents


def _hint(key: str) -> str:
    """Suggest the known key with the most similar name; a key of a section is named with its section."""
    sections = {"packing": PackingSettings, "supports": SupportSettings, "cells": CellSettings}
    if key.removesuffix("s") in KEYS:  # entries are named in the singular: [[rule]], [[part]]
        return f" (did you mean {key.removesuffix('s')!r}?)"
    for section, cls in sections.items():
        if key in {each.name for each in fields(cls)}:
            return f" (did you mean '{section}.{key}'?)"
    return nearest_hint(key, KEYS)
