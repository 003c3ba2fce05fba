"""The figures of runs side by side, and the findings that not all of them have."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any, Literal, NamedTuple

from amprep.report.comparison.read import ComparedRun

Better = Literal["less", "more", ""]

_LEAST_CHANGE = 0.05
"""Least difference (percent) that is told."""

_Figure = Callable[[Mapping[str, Any]], float | str | None]


class ComparedFigure(NamedTuple):
    """One figure of all runs.

    Attributes
    ----------
    title, unit
        What it is, and its unit.
    values
        The value of each run; None where it is unknown.
    better
        Whether less or more is better; empty where neither is.
    digits
        Decimals that are shown.
    """

    title: str
    unit: str
    values: tuple[float | str | None, ...]
    better: Better
    digits: int

    @property
    def best(self) -> tuple[bool, ...]:
        """Which runs have the best value; none where all look equal, or neither less nor more is better."""
        shown = [
            round(value, self.digits) if isinstance(value, int | float) else None for value in self.values
        ]
        known = [value for value in shown if value is not None]
        if not self.better or not known or min(known) == max(known):
            return (False,) * len(self.values)
        best = min(known) if self.better == "less" else max(known)
        return tuple(value == best for value in shown)

    def words(self) -> list[str]:
        """Return each value as text, with the difference to the first one in percent."""
        first = self.values[0]
        return [self._text(value, first if number else None) for number, value in enumerate(self.values)]

    def _text(self, value: float | str | None, first: float | str | None) -> str:
        if value is None or isinstance(value, str):
            return value or "unknown"
        text = f"{value:,.{self.digits}f} {self.unit}".strip()
        change = 100.0 * (value - first) / abs(first) if isinstance(first, int | float) and first else 0.0
        return f"{text} ({change:+.1f} %)" if abs(change) >= _LEAST_CHANGE else text


class ComparedFinding(NamedTuple):
    """What must be fixed not equally often in all runs: the part and the message, and how often each run has it."""

    part: str
    message: str
    runs: tuple[int, ...]


def figures_of(runs: Sequence[ComparedRun]) -> list[ComparedFigure]:
    """Return the figures of runs, row by row; rows that are unknown in all runs are left out."""
    found = [
        ComparedFigure(title, unit, tuple(figure(run.report) for run in runs), better, digits)
        for title, unit, figure, better, digits in _FIGURES
    ]
    return [each for each in found if any(value is not None for value in each.values)]


def findings_in_some(runs: Sequence[ComparedRun]) -> list[ComparedFinding]:
    """Return what must be fixed more often in some of the runs than in others."""
    found = [_urgent(run.report) for run in runs]
    every = sorted(set().union(*found))
    counts = [(each, tuple(own[each] for own in found)) for each in every]
    return [ComparedFinding(*each, numbers) for each, numbers in counts if len(set(numbers)) > 1]


def must_fix_anything(runs: Sequence[ComparedRun]) -> bool:
    """Tell whether something must be fixed in one of the runs."""
    return any(_urgent(run.report) for run in runs)


def _urgent(report: Mapping[str, Any]) -> Counter[tuple[str, str]]:
    """Return how often each part and message is among what must be fixed."""
    urgent = [each for each in _entries(report, "findings") if each.get("triage") == "must fix"]
    return Counter((str(each.get("part")), str(each.get("message"))) for each in urgent)


def _entries(report: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    found = report.get(key)
    return [each for each in found if isinstance(each, dict)] if isinstance(found, list) else []


def _number(value: object) -> float | None:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    with suppress(OverflowError):
        return float(value) if math.isfinite(float(value)) else None
    return None


def _at(entry: Mapping[str, Any], keys: str) -> object:
    """Return the value at keys with dots between them; None where one is missing."""
    value: object = entry
    for key in keys.split("."):
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _of_builds(keys: str, combine: Callable[[list[float]], float], scale: float = 1.0) -> _Figure:
    """Return a figure that combines those of all builds; None where one of them is unknown."""

    def figure(report: Mapping[str, Any]) -> float | None:
        values = [_number(_at(build, keys)) for build in _entries(report, "builds")]
        known = [value for value in values if value is not None]
        return combine(known) * scale if known and len(known) == len(values) else None

    return figure


def _counted(key: str) -> _Figure:
    return lambda report: float(len(_entries(report, key)))


def _of_run(keys: str) -> _Figure:
    return lambda report: _number(_at(report, keys))


def _text(keys: str) -> _Figure:
    return lambda report: str(_at(report, keys) or "") or None


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)


def _placed(report: Mapping[str, Any]) -> float:
    return float(sum(len(_entries(build, "parts")) for build in _entries(report, "builds")))


def _seconds(report: Mapping[str, Any]) -> float | None:
    seconds = [_number(each.get("seconds")) for each in _entries(report, "stages")]
    return sum(each for each in seconds if each is not None) if seconds else None


_FIGURES: tuple[tuple[str, str, _Figure, Better, int], ...] = (
    ("Packer", "", _text("settings.packing.strategy"), "", 0),
    ("Support router", "", _text("settings.supports.strategy"), "", 0),
    ("Lattice cell", "", _text("settings.cells.strategy"), "", 0),
    ("Packing", "", _text("status"), "", 0),
    ("Must fix", "", _of_run("triage.must_fix"), "less", 0),
    ("Worth a check", "", _of_run("triage.worth_a_check"), "less", 0),
    ("Parts placed", "", _placed, "more", 0),
    ("Copies unplaced", "", _counted("unplaced"), "less", 0),
    ("Builds", "", _counted("builds"), "less", 0),
    ("Plate use, mean", "%", _of_builds("printing.plate_use", _mean, 100.0), "more", 1),
    ("Density, mean", "%", _of_builds("density", _mean, 100.0), "more", 2),
    ("Height, all builds", "mm", _of_builds("height_mm", sum), "less", 1),
    ("Layers", "", _of_builds("printing.layers", sum), "less", 0),
    ("Printing time", "h", _of_builds("printing.hours", sum), "less", 1),
    ("Mass of parts", "g", _of_builds("printing.parts_g", sum), "", 1),
    ("Mass of supports", "g", _of_builds("printing.supports_g", sum), "less", 1),
    ("Volume of supports", "cm³", _of_builds("supports.volume_mm3", sum, 1e-3), "less", 2),
    ("Contact area", "mm²", _of_builds("supports.contact_area_mm2", sum), "less", 1),
    ("Unsupported area", "mm²", _of_builds("supports.unsupported_mm2", sum), "less", 2),
    ("Seconds of the run", "s", _seconds, "less", 1),
)
"""Title, unit, figure, what is better, and decimals of each row."""
