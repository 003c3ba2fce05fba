"""Judge a build against every promise, whether it was just made or read from a file."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import judge_placed
from amprep.checks.supports import bodies as cells
from amprep.checks.supports import coverage, limits, xy_distance
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.supports.solids import KnownSolids
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
    *limits.PROMISES,
    coverage.PROMISE,
)
"""Names of all promises, in the order in which they are judged."""


class JudgedBuild(NamedTuple):
    """The result of judging a build.

    Attributes
    ----------
    violations
        Every broken promise.
    pairs
        How many pairs of parts were judged by which method.
    extent
        For promises on supports that depend on the rules of the build: limit, tolerance, and what was judged.
    """

    violations: tuple[Violation, ...]
    pairs: PairCounts
    extent: dict[str, str]


def verify_build(build: Build, *, stop: Stop | None = None, progress: Progress = silent) -> JudgedBuild:
    """Return every broken promise: of parts, of supports, of overhangs without support, and of limits of supports.

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
    solids = KnownSolids()
    progress(0.0, "parts")
    found, pairs = judge_placed(build.parts, build.settings, stop)
    judges: tuple[tuple[str, Callable[[], list[Violation]]], ...] = (
        ("supports", lambda: [*check_bodies(build, stop, solids), *check_xy_distance(build, stop)]),
        ("coverage", lambda: check_coverage(build)),
    )
    for index, (name, judge) in enumerate(judges, start=1):
        progress(index / (len(judges) + 2), name)
        found += judge()
    progress(1.0 - 1.0 / (len(judges) + 2), "limits")
    judged = limits.check_limits(build, stop, solids)
    progress(1.0, "verified")
    return JudgedBuild((*found, *judged.violations), pairs, judged.extent)


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
