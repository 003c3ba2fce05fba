"""What came of a run: the build files, the report, and a sentence for the user."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .process import Ended

_DONE, _INCOMPLETE = 0, 1
"""Exit codes of amprep with which files are written."""


@dataclass(frozen=True)
class Outcome:
    """The result of a run.

    Attributes
    ----------
    text
        One or two sentences for the user.
    builds
        Paths of the build files; empty if the run failed or was cancelled.
    report
        Path of the report for people, or None.
    is_good
        Whether nothing must be fixed.
    is_cancelled
        Whether the user ended the run.
    has_all
        Whether one build holds every model, so that it may replace them.
    """

    text: str
    builds: tuple[Path, ...] = ()
    report: Path | None = None
    is_good: bool = False
    is_cancelled: bool = False
    has_all: bool = False


def outcome_of(ended: Ended, folder: Path) -> Outcome:
    """Return the outcome of ``amprep run --json``.

    Parameters
    ----------
    ended
        How the process ended.
    folder
        Folder of the files.
    """
    if ended.cancelled and ended.code != _DONE:  # the files may have been there before the user cancelled
        return Outcome("Cancelled. Nothing was written.", is_cancelled=True)
    if ended.code not in (_DONE, _INCOMPLETE):
        return Outcome(ended.error or f"amprep ended with exit code {ended.code}.")
    try:
        return _read(json.loads(ended.output), folder, is_good=ended.code == _DONE)
    except (ValueError, KeyError, TypeError, AttributeError):
        return Outcome(ended.error or "amprep printed no report that this plugin can read; update both.")


def _read(report: dict[str, Any], folder: Path, *, is_good: bool) -> Outcome:
    # names alone: nothing outside the folder is opened
    builds = tuple(folder / Path(build["file"]).name for build in report["builds"] if build["file"])
    page = folder / Path(f"{report['job']}.report.html").name
    has_all = len(builds) == 1 and not report["unplaced"]
    shown = page if page.is_file() else None
    return Outcome(_sentences(report, builds), builds, shown, is_good, has_all=has_all)


def _sentences(report: dict[str, Any], builds: tuple[Path, ...]) -> str:
    parts = sum(len(build["parts"]) for build in report["builds"])
    height = max((build["height_mm"] for build in report["builds"]), default=0.0)
    sentences = [f"{_counted(parts, 'part')} in {_counted(len(builds), 'build')}, {height:.0f} mm high."]
    if report["unplaced"]:
        sentences.append(f"{_counted(len(report['unplaced']), 'part')} not placed.")
    if report["triage"]["must_fix"]:
        sentences.append(
            f"{_counted(report['triage']['must_fix'], 'finding')} that must be fixed; see the report."
        )
    if builds and (len(builds) > 1 or report["unplaced"]):
        sentences.append(f"The models stay on the plate, because no build holds all; see {builds[0].parent}.")
    return " ".join(sentences)


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
