"""Judge a build against every promise, whether it was just made or read from a file."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from amprep.checks.listed import free_below
from amprep.checks.neighbours import apart, islands
from amprep.checks.neighbours.islands import check_islands
from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import judge_placed
from amprep.checks.printed import as_recorded, unchanged
from amprep.checks.printed.found import PrintedFile
from amprep.checks.removal import access, powder
from amprep.checks.supports import bodies as cells
from amprep.checks.supports import coverage, limits, xy_distance
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.supports.xy_distance import check_xy_distance
from amprep.checks.violation import Violation
from amprep.model import Build, Progress, Stop, Unsupported, silent
from amprep.model.counting import counted
from amprep.pipeline.verifying.copies import TOLERANCE, find_copies
from amprep.pipeline.verifying.extents import extents_of, removal_extents
from amprep.pipeline.verifying.nearby import nearby
from amprep.workers import share_out

_OF_PARTS = (
    "inside build volume",
    "outside forbidden zones",
    "no intersection",
    "clearance",
    "lift",
    "allowed motion",
    "part unchanged",
    unchanged.PROMISE,
    unchanged.RECORD,
)
_OF_BODIES = (cells.CLOSED, cells.INSIDE, cells.STANDING, cells.PENETRATION, xy_distance.PROMISE)

PROMISES = (
    as_recorded.PROMISE,
    *_OF_PARTS,
    *_OF_BODIES[:-1],
    islands.PROMISE,
    *apart.PROMISES,
    xy_distance.PROMISE,
    *limits.PROMISES,
    coverage.PROMISE,
    free_below.PROMISE,
    powder.PROMISE,
    access.PROMISE,
)
"""Names of all promises, in the order in which they are judged."""

_BY_COPY = (*_OF_BODIES, islands.PROMISE, *limits.PROMISES, coverage.PROMISE, free_below.PROMISE)
"""Promises that are judged of the supports of one of several equal copies."""


@dataclass(frozen=True)
class Verification:
    """Result of verifying a build against every promise.

    Attributes
    ----------
    violations
        The broken promises; empty when all hold.
    pairs
        How many pairs of parts were judged by which method: their enclosing boxes, the distance of their triangles, or
        the intersection of their solids.
    extent
        For promises that depend on the rules of the build or on what it is verified against: limit, tolerance, and
        what was judged.
    weaker
        Settings in the file that are weaker than usual, in words; empty for a build in memory.
    """

    violations: tuple[Violation, ...]
    pairs: PairCounts = field(default_factory=PairCounts)
    extent: dict[str, str] = field(default_factory=dict)
    weaker: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every promise holds."""
        return not self.violations

    def __str__(self) -> str:
        """One line per broken promise."""
        lines = map(str, self.violations)
        return "\n".join(lines) or "every promise holds"


def verify_build(
    build: Build,
    *,
    printed: PrintedFile | None = None,
    removability: bool = False,
    only: Collection[int] | None = None,
    stop: Stop | None = None,
    progress: Progress = silent,
) -> Verification:
    """Return every broken promise: of parts, of supports, of overhangs without support, and of limits of supports.

    Of equal copies with equal supports, those of one are judged; if that breaks a promise, those of all.

    Parameters
    ----------
    build
        The build.
    printed
        What the target of its file would print; None for a build that is in no file.
    removability
        Whether powder and access to contacts are judged, which takes long.
    only
        Parts whose supports and overhangs are judged, those that share supports with them included; None for all. The
        places of all parts, and the distances of all supports, are judged in any case.
    stop
        Ends the judges early. A promise that was not judged to the end before the deadline counts as broken.
    progress
        Called before each group of judges.
    """
    stop = stop or Stop()
    like = find_copies(build) if only is None and not removability else {}
    if like:
        first = verify_build(
            build,
            printed=printed,
            removability=removability,
            only=sorted(set(range(len(build.parts))) - set(like)),
            stop=stop,
            progress=progress,
        )
        if stop() or not any(each.promise in _BY_COPY for each in first.violations):
            return replace(first, extent=first.extent | _of_copies(first.extent, len(like)))
    judges = _judges(build, only, stop, removability=removability)
    judged = share_out(
        lambda number: judges[number].judge()._replace(is_late=stop()),
        [each.work for each in judges],
        is_cancelled=stop,
        done=lambda count: progress(
            count / (len(judges) + 1), f"{count} of {len(judges)} groups of promises judged"
        ),
    )
    seen = [] if printed is None else as_recorded.check_as_printed(build, printed)
    progress(1.0, "verified")
    found = [violation for each in judged for violation in each.violations]
    late = [each for number, each in enumerate(judges) if number >= len(judged) or judged[number].is_late]
    found += [_not_judged(build, promise) for each in late for promise in each.promises]
    pairs = sum((each.pairs for each in judged), PairCounts())
    own = {promise: words for each in judged for promise, words in (each.extent or {}).items()}
    extent = extents_of(build, pairs, printed) | own | removal_extents(removability)
    return Verification((*seen, *found), pairs, extent)


def _of_copies(extent: Mapping[str, str], count: int) -> dict[str, str]:
    """Return for the promises of supports what was judged, if so many parts were compared with judged ones instead."""
    compared = f"those of {counted(count, 'copy', 'copies')} equal judged ones to {TOLERANCE:g} mm"
    return {
        each: f"{extent[each]}; {compared}"
        for each in _BY_COPY
        if each in extent and not extent[each].startswith(limits.NOT_JUDGED)
    }


class _Judged(NamedTuple):
    """What a judge found, how many pairs it judged, and to what extent it judged promises."""

    violations: list[Violation]
    pairs: PairCounts = PairCounts()
    extent: Mapping[str, str] | None = None
    is_late: bool = False


class _Judge(NamedTuple):
    """A judge, which needs no other one, its promises, and its estimated work in triangles."""

    work: float
    promises: tuple[str, ...]
    judge: Callable[[], _Judged]


def _not_judged(build: Build, promise: str) -> Violation:
    message = "it was not judged to the end within the time limit; verify the file"
    return Violation(promise, build.settings.build_id, message)


def _judges(build: Build, only: Collection[int] | None, stop: Stop, *, removability: bool) -> list[_Judge]:
    """Return the judges of a build in the order in which what they find is told; for `only`, see `verify_build`."""
    chosen = build if only is None else nearby(build, only)
    listed = build if only is None else replace(build, unsupported=_listed_of(build, only))
    solids = KnownSolids()
    parts = float(sum(len(each.mesh.triangles) for each in build.parts))
    supports = float(sum(len(each.mesh.triangles) for each in chosen.supports))

    def placed() -> _Judged:
        found, pairs = judge_placed(build.parts, build.settings, stop)
        return _Judged(found + unchanged.check_unchanged(build), pairs)

    def bodies() -> _Judged:
        return _Judged([*check_bodies(chosen, stop, solids), *check_xy_distance(chosen, stop)])

    def neighbours() -> _Judged:
        return _Judged([*check_islands(chosen, stop, solids), *apart.check_apart(build, stop, solids)])

    def covered() -> _Judged:
        return _Judged([*check_coverage(chosen), *free_below.check_listed(listed)])

    def removal() -> _Judged:
        return _Judged([*powder.check_powder(chosen, stop), *access.check_access(chosen, stop)])

    def limited() -> _Judged:
        found = limits.check_limits(chosen, stop, solids)
        return _Judged(found.violations, extent=found.extent)

    judges = [
        _Judge(parts, _OF_PARTS, placed),
        _Judge(2.0 * supports + parts, _OF_BODIES, bodies),
        _Judge(supports, (islands.PROMISE, *apart.PROMISES), neighbours),
        _Judge(supports + parts, (coverage.PROMISE, free_below.PROMISE), covered),
    ]
    if removability:
        judges += [_Judge(8.0 * supports, (powder.PROMISE, access.PROMISE), removal)]
    return [*judges, _Judge(4.0 * supports, limits.PROMISES, limited)]


def _listed_of(build: Build, parts: Collection[int]) -> tuple[Unsupported, ...]:
    return tuple(each for each in build.unsupported if each.part in parts)
