"""The settings of a job by which supports are planned, as a build file records them, and the job that they make."""

from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from pathlib import Path, PurePath
from typing import Any

from amprep.errors import JobError
from amprep.job.loading import make_job
from amprep.job.settings.job import Job
from amprep.model.build import BuildSettings
from amprep.model.supports.rules import SupportRules

_KEYS = ("seed", "supports", "cells", "rule")
_OF_BUILD = {"supports": (*(field.name for field in fields(SupportRules)), "enabled", "write_as")}
"""Keys whose values are in the settings of a build already."""


def planning_table(job: Job) -> dict[str, Any]:
    """Return the settings by which the supports of a job are planned, with the keys of a job file.

    Rules and sizes that the settings of a build state are left out. Of files that declare a cell the name remains.
    """
    cells = {**_stated(job, "cells"), "strategy": _name(job.cells.strategy)}
    table = {"seed": job.seed, "supports": _stated(job, "supports"), "cells": cells}
    rules = [
        {**entry, "cell": _name(entry["cell"])} if "cell" in entry else dict(entry)
        for entry in job.table.get("rule", [])
    ]
    return {**table, "rule": rules} if rules else table


def job_of_build(settings: BuildSettings, path: Path) -> Job:
    """Return the job by which the supports of a build were planned.

    Its printer is that of the build. A cell that a file declares is searched beside the build file.

    Parameters
    ----------
    settings
        Settings of the build, with those of its planning.
    path
        The build file, for messages and as the place of other files.

    Raises
    ------
    JobError
        If the recorded settings are damaged, or the file of a cell is missing.
    """
    stated = {key: settings.planning[key] for key in _KEYS if key in settings.planning}
    for cell in _cells_in(stated):
        if PurePath(cell).name != cell:
            raise JobError(f"{path}: the recorded cell {cell[:80]!r} must be a name; give the job by --job")
    rules = {field.name: getattr(settings.rules, field.name) for field in fields(SupportRules)}
    own = {**rules, "enabled": settings.supported, "write_as": settings.supports_as}
    supports = stated.get("supports", {})
    table = {
        **stated,
        "target": settings.target,
        "packing": {"clearance_mm": settings.clearance, "lift_mm": settings.lift},
        "supports": {**supports, **own} if isinstance(supports, Mapping) else supports,
    }
    job = make_job(table, name=settings.build_id, folder=path.resolve().parent, source=str(path))
    pitch = settings.sizes.square_mm or job.supports.pitch_mm
    return replace(
        job,
        printer=replace(job.printer, name=settings.printer, space=settings.space),
        supports=replace(job.supports, pitch_mm=pitch or None),
    )


def _stated(job: Job, section: str) -> dict[str, Any]:
    """Return the settings of a section that have a value and are not in the settings of a build."""
    values = asdict(getattr(job, section))
    left_out = _OF_BUILD.get(section, ())
    return {key: value for key, value in values.items() if key not in left_out and value is not None}


def _name(cell: str) -> str:
    """Return a cell's name, or the name of the file that declares it."""
    return cell.replace("\\", "/").rpartition("/")[2]


def _cells_in(table: Mapping[str, Any]) -> list[str]:
    """Return the texts that name cells; other values are refused when the job is made."""
    rules = table.get("rule", [])
    entries = rules if isinstance(rules, list) else []
    cells = [table.get("cells", {}), *entries]
    found = [each.get(key) for each in cells if isinstance(each, Mapping) for key in ("strategy", "cell")]
    return [each for each in found if isinstance(each, str)]
