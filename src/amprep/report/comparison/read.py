"""Read the JSON reports of runs that are compared."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from amprep.errors import InputError
from amprep.files import read_json

_LARGEST = 256 << 20
"""Largest size of a report, bytes."""

_LARGEST_PICTURE = 8 << 20
"""Largest size of a picture that a page contains, bytes."""

_FORMAT = 2
"""Format of the reports that can be compared."""

_PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class ComparedRun:
    """A run, as its JSON report describes it.

    Attributes
    ----------
    name
        Name that tells it from the others.
    folder
        Folder of the report, in which its pictures are.
    report
        The whole report.
    """

    name: str
    folder: Path
    report: Mapping[str, Any]

    @property
    def builds(self) -> Sequence[Mapping[str, Any]]:
        """The builds of the run."""
        return [each for each in self.report["builds"] if isinstance(each, dict)]

    def picture(self, build: Mapping[str, Any]) -> str:
        """Return the picture of a build in base64; empty if it is missing, too large, or no PNG in the folder."""
        name, contents = str(build.get("picture") or ""), b""
        with suppress(OSError, ValueError):
            path = self.folder / name
            if Path(name).name == name and path.is_file() and path.stat().st_size <= _LARGEST_PICTURE:
                contents = path.read_bytes()
        return b64encode(contents).decode("ascii") if contents.startswith(_PNG) else ""


def read_runs(paths: Sequence[Path]) -> list[ComparedRun]:
    """Read the reports of some runs.

    Runs are named after their jobs; where these are equal, after what differs: packer, router and cell, or the folder.

    Raises
    ------
    InputError
        If a file is no report of a run, or one of another format.
    """
    reports = [_read(path) for path in paths]
    return [
        ComparedRun(name, path.resolve().parent, report)
        for name, path, report in zip(_names(paths, reports), paths, reports, strict=True)
    ]


def _read(path: Path) -> Mapping[str, Any]:
    report = read_json(path, "the JSON report of a run", _LARGEST)
    if not isinstance(report, dict) or not isinstance(report.get("builds"), list) or "triage" not in report:
        raise InputError(f"{path}: not a report of a run: expected the file NAME.report.json of amprep run")
    if report.get("format") != _FORMAT:
        raise InputError(
            f"{path}: its format is {report.get('format')}, expected {_FORMAT}; run the job again"
        )
    cleaned: Mapping[str, Any] = _without_controls(report)
    return cleaned


def _without_controls(value: Any) -> Any:
    """Return a value of JSON whose texts have no character that a terminal would obey, or cannot show."""
    if isinstance(value, str):
        return "".join(each if each.isprintable() else " " for each in value)
    if isinstance(value, dict):
        return {key: _without_controls(each) for key, each in value.items()}
    return [_without_controls(each) for each in value] if isinstance(value, list) else value


def _names(paths: Sequence[Path], reports: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a different name for each run."""
    jobs = [str(report.get("job", "")) for report in reports]
    chosen = [" · ".join(_strategies(report)) for report in reports]
    folders = [path.resolve().parent.name for path in paths]
    numbers = [f"run {number}" for number in range(1, len(paths) + 1)]
    return next(names for names in (jobs, chosen, folders, numbers) if len(set(names)) == len(paths))


def _strategies(report: Mapping[str, Any]) -> list[str]:
    """Return the names of packer, router and cell."""
    settings = report.get("settings")
    sections = [
        settings.get(each) if isinstance(settings, dict) else None
        for each in ("packing", "supports", "cells")
    ]
    return [
        str(section["strategy"])
        for section in sections
        if isinstance(section, dict) and "strategy" in section
    ]
