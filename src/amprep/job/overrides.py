"""Change settings of a job: by dotted keys from Python, or by ``--set KEY=VALUE`` from the command line."""

import json
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from amprep.errors import JobError
from amprep.job.loading import make_job
from amprep.job.settings.job import Job

_OPENING = ('"', "'", "[", "{")
"""A value that begins with one of these and is no TOML value is not complete, and no text."""

_PARAMS_OF = {
    "packing.strategy": "packing.params",
    "supports.strategy": "supports.params",
    "cells.strategy": "cells.params",
}
_NAME_OR_FILE = ("printer", "material", "cells.strategy", "labels")


def apply_sets(job: Job, sets: Sequence[str]) -> Job:
    """Return the job with each ``KEY=VALUE`` set; keys are dotted, values are written as in TOML.

    What is no TOML value is a text: ``cells.strategy=my cell.stl``.

    Raises
    ------
    JobError
        For text without ``=``, a value that is not TOML, and every setting that a job file may not have.
    """
    table: Mapping[str, Any] = job.table
    for text in sets:
        table = _merged(table, _parsed(text), f"--set {text}")
    return _remade(job, table, "--set" if sets else "")


def override(job: Job, changes: Mapping[str, Any]) -> Job:
    """Return the job with other settings.

    A new strategy drops the parameters of the old one. Paths are relative to the current folder.

    Parameters
    ----------
    job
        Job to start from; it is not modified.
    changes
        Settings by the dotted keys of a job file, for example ``{"supports.pitch_mm": 0.8}``. A value of None
        leaves the setting as it is.

    Raises
    ------
    JobError
        For an unknown key or a value that a job file may not have.
    """
    given = {key: value for key, value in changes.items() if value is not None}
    if not given:
        return job
    table: Mapping[str, Any] = job.table
    for key, value in given.items():
        new = _absolute(value) if key in _NAME_OR_FILE else value
        if key in _PARAMS_OF and new != _setting(job, key):
            table = _with(table, _PARAMS_OF[key], {})
        table = _with(table, key, new)
    return _remade(job, table, "")


def _setting(job: Job, key: str) -> Any:
    section, _, name = key.partition(".")
    return getattr(getattr(job, section), name)


def _with(table: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Return the table with the value at a dotted key."""
    first, dot, rest = key.partition(".")
    if not dot:
        return {**table, key: value}
    inner = table.get(first, {})
    return {**table, first: _with(inner if isinstance(inner, Mapping) else {}, rest, value)}


def _absolute(name: Any) -> Any:
    """Return the path of a file absolute, because it is relative to the current folder; a name stays a name."""
    return str(Path(name).resolve()) if isinstance(name, str | Path) and Path(name).is_file() else name


def _parsed(text: str) -> dict[str, Any]:
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or "\n" in text:
        raise JobError(f"--set: expected key=value, for example supports.pitch_mm=0.8, got {text!r}")
    for candidate in (value, _quoted(value)):
        try:
            return tomllib.loads(f"{key} = {candidate}")
        except (tomllib.TOMLDecodeError, RecursionError):
            continue
    raise JobError(f'--set {text}: expected a TOML value: a number, true, false, "text" or a [list]')


def _quoted(value: str) -> str:
    """Return a value as a TOML text, unless it begins like another TOML value."""
    text = value.strip()
    return value if text.startswith(_OPENING) or not text else json.dumps(text, ensure_ascii=False)


def _merged(table: Mapping[str, Any], change: Mapping[str, Any], where: str) -> dict[str, Any]:
    result = dict(table)
    for key, value in change.items():
        old = result.get(key, {})
        if isinstance(value, Mapping) and isinstance(old, list):
            raise JobError(f"{where}: entries of a list cannot be set; write them in a job file")
        nested = isinstance(value, Mapping) and isinstance(old, Mapping)
        result[key] = _merged(old, value, where) if nested else value
    return result


def _remade(job: Job, table: Mapping[str, Any], note: str) -> Job:
    source = f"{job.source} with {note}" if note else job.source
    return make_job(table, name=job.name, folder=job.folder, source=source)
