"""Judge a build against every promise, whether it was just made or read from a file."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import judge_placed
from amprep.checks.supports import bodies as cells
from amprep.checks.supports import coverage, xy_distance
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.supports.xy_distance import check_xy_distance
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
"""Names of all promises, in the order in which they are judged."""


class JudgedBuild(NamedTuple):
    """Every broken promise of a build, and how many pairs of parts were judged by which method."""

    violations: tuple[Violation, ...]
    pairs: PairCounts


def verify_build(build: Build, *, stop: Stop | None = None, progress: Progress = silent) -> JudgedBuild:
    """Return every broken promise: of parts, then of supports, then of overhangs without support.

    Parameters
    ----------
    build
        The build.
    stop
        Ends the check of parts and supports early.
    progress
        Called before each group of judges.
    """
    stop = stop or Stop()
    progress(0.0, "parts")
    found, pairs = judge_placed(build.parts, build.settings, stop)
    judges: tuple[tuple[str, Callable[[], list[Violation]]], ...] = (
        ("supports", lambda: [*check_bodies(build, stop), *check_xy_distance(build, stop)]),
        ("coverage", lambda: check_coverage(build)),
    )
    for index, (name, judge) in enumerate(judges, start=1):
        progress(index / (len(judges) + 1), name)
        found += judge()
    progress(1.0, "verified")
    return JudgedBuild(tuple(found), pairs)


def verify_file(path: Path, *, stop: Stop | None = None, progress: Progress = silent) -> JudgedBuild:
    """Read a build file and judge the build from the file alone.

    Parameters
    ----------
    path
        The build file.
    stop, progress
        See `verify_build`.

    Raises
    ------
    InputError
        If the file is not a build that amprep wrote.
    """
    from amprep.threemf import read_build

    return verify_build(read_build(path), stop=stop, progress=progress)
