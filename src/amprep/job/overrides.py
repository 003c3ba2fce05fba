"""Changes a job from the command line: `--set key=value`, and the options for strategies and printer."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from amprep.errors import JobError
from amprep.job.loading import make_job
from amprep.job.settings.job import Job

_BARE_WORD = re.compile(r"[A-Za-z_][\w.+-]*")
_STRATEGIES = {"packer": "packing", "router": "supports", "cell": "cells"}


def apply_sets(job: Job, sets: Sequence[str]) -> Job:
    """Return the job with each ``key=value`` set; keys are dotted, values are written as in TOML.

    A bare word stands for a text: ``cells.strategy=prism``.

    Raises
    ------
    JobError
        For text without ``=``, a value that is not TOML, and whatever a job file would be refused for.
    """
    table: Mapping[str, Any] = job.table
    for text in sets:
        table = _merged(table, _parsed(text), f"--set {text}")
    return _remade(job, table, "--set" if sets else "")


def override(
    job: Job,
    *,
    printer: str | None = None,
    packer: str | None = None,
    router: str | None = None,
    cell: str | None = None,
    target: str | None = None,
    seed: int | None = None,
    supports_as: str | None = None,
    lattice: str | None = None,
    connector: str | None = None,
    base: str | None = None,
) -> Job:
    """Return the job with the options given; None keeps what the job says.

    Another strategy than the job's own drops the job's parameters, which belong to the old one. Paths are
    relative to the current folder.

    Raises
    ------
    JobError
        For an unknown printer or target, or a seed out of bounds.
    """
    changes: dict[str, Any] = {"printer": _absolute(printer), "target": target, "seed": seed}
    table = {**job.table, **{key: value for key, value in changes.items() if value is not None}}
    for option, name in (("packer", packer), ("router", router), ("cell", _absolute(cell))):
        if name is not None:
            section = _STRATEGIES[option]
            table[section] = _with_strategy(job, table.get(section, {}), section, name)
    words = (
        *(("supports", "write_as", supports_as), ("cells", "lattice", lattice)),
        *(("cells", "connector", connector), ("cells", "base", base)),
    )
    for section, key, word in words:
        if word is not None:
            table[section] = {**table.get(section, {}), key: word}
    return _remade(job, table, "")


def _with_strategy(job: Job, section: Mapping[str, Any], key: str, name: str) -> dict[str, Any]:
    unchanged = getattr(job, key).strategy == name
    kept = {k: value for k, value in section.items() if unchanged or k != "params"}
    return {**kept, "strategy": name}


def _absolute(name: str | None) -> str | None:
    """Return the path of a file absolute: on the command line it starts at the current folder."""
    return str(Path(name).resolve()) if name is not None and Path(name).is_file() else name


def _parsed(text: str) -> dict[str, Any]:
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or "\n" in text:
        raise JobError(f"--set: expected key=value, e.g. supports.pitch_mm=0.8, got {text!r}")
    for candidate in (value, f'"{value.strip()}"' if _BARE_WORD.fullmatch(value.strip()) else value):
        try:
            return tomllib.loads(f"{key} = {candidate}")
        except (tomllib.TOMLDecodeError, RecursionError):
            continue
    raise JobError(f'--set {text}: expected a TOML value: a number, true, false, "text" or a [list]')


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
