"""Judges a build against every promise; the same for a run's own output and for a stranger's file."""

from collections.abc import Callable
from pathlib import Path

from amprep.checks.packing.parts_placed import check_placed
from amprep.checks.supports import bodies as cells
from amprep.checks.supports import coverage, xy_distance
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.supports.xy_distance import check_gap
from amprep.checks.violation import Violation
from amprep.model import Build, Progress, Stop, silent

PROMISES = (
    "inside build volume",
    "outside forbidden zones",
    "no intersection",
    "clearance",
    "lift",
    "allowed motion",
    "part unchanged",
    cells.CLOSED,
    cells.INSIDE,
    cells.STANDING,
    cells.PENETRATION,
    xy_distance.PROMISE,
    coverage.PROMISE,
)
"""The names of all promises, in the order they are judged."""


def verify_build(
    build: Build, *, stop: Stop | None = None, progress: Progress = silent
) -> tuple[Violation, ...]:
    """Return every broken promise of `build`, parts first, then supports, then what is left unsupported."""
    stop = stop or Stop()
    judges: tuple[tuple[str, Callable[[], list[Violation]]], ...] = (
        ("parts", lambda: check_placed(build.parts, build.settings, stop)),
        ("supports", lambda: [*check_bodies(build, stop), *check_gap(build, stop)]),
        ("coverage", lambda: check_coverage(build)),
    )
    violations: list[Violation] = []
    for index, (name, judge) in enumerate(judges):
        progress(index / len(judges), name)
        violations += judge()
    progress(1.0, "judged")
    return tuple(violations)


def verify_file(
    path: Path, *, stop: Stop | None = None, progress: Progress = silent
) -> tuple[Violation, ...]:
    """Read a written build back and judge it from the file alone.

    Raises
    ------
    InputError
        If the file is not a build that amprep wrote.
    """
    from amprep.threemf import read_build

    return verify_build(read_build(path), stop=stop, progress=progress)
