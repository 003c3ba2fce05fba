"""An order in which the bodies of a build can be taken out one after another."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.geometry.removal.blocking import Blocking
from amprep.geometry.removal.paths import Motion, find_path

# Strategy (Wilson and Latombe 1994, doi 10.1016/0004-3702(94)90048-9). For each direction, a graph has an arc from each
# body to those that block it. A body without arcs to bodies that remain can leave. If none can, a strongly connected
# component without arcs to others can leave as a whole; the smallest one does, and is then taken apart by itself. Only
# a group that remains as a whole in every direction is searched for paths of several motions; if there is none, its
# bodies are locked into each other.
# Bodies leave upwards as long as possible. A body is not asked again while the one that blocked it last remains, so
# that each pair is asked at most once for a direction, and most pairs, of which the upper one leaves first, never.


def _directions() -> Floats:
    """Return upwards, then the directions with fewest components: none of them points downwards."""
    grid = [(x, y, z) for z in (1, 0) for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y, z) != (0, 0, 0)]
    grid.sort(key=lambda each: (np.count_nonzero(each), -each[2]))
    return frozen([np.array(each) / np.linalg.norm(each) for each in grid], np.float64)


DIRECTIONS = _directions()
"""Seventeen unit vectors ``(17, 3)``: upwards, sideways along the axes and between them, and obliquely upwards."""

MOST_PAIRS = 200
"""Pairs of bodies, the box of one blocking that of the other, of which it is determined which one must leave first."""


@dataclass(frozen=True)
class RemovalStep:
    """Bodies that leave together.

    Attributes
    ----------
    bodies
        One, or a group whose bodies must leave together.
    path
        Motions one after another, of which the last has no end.
    within
        The group that left before and that is now taken apart; empty for bodies that leave the build.
    after
        Bodies that left earlier and would have blocked the motion; None if not determined.
    """

    bodies: tuple[int, ...]
    path: tuple[Motion, ...]
    within: tuple[int, ...] = ()
    after: tuple[int, ...] | None = None


@dataclass(frozen=True)
class RemovalOrder:
    """Steps that take out all bodies, and what hinders them.

    Attributes
    ----------
    steps
        In their order.
    locked
        Groups of bodies that are locked into each other: no body of them can leave the others.
    unknown
        Bodies that were not judged before the search was stopped.
    """

    steps: tuple[RemovalStep, ...] = ()
    locked: tuple[tuple[int, ...], ...] = ()
    unknown: tuple[int, ...] = ()


def find_removal_order(
    blocking: Blocking, stop: Callable[[], bool] = lambda: False, paths: bool = True
) -> RemovalOrder:
    """Return an order in which all bodies leave, singly where that is found.

    Paths of several motions are a limited search: a group reported as locked may have a path that was not found.

    Parameters
    ----------
    blocking
        The bodies and the directions in which they may leave.
    stop
        Ends the search early.
    paths
        Whether paths of several motions are searched for.
    """
    steps: list[RemovalStep] = []
    locked: list[tuple[int, ...]] = []
    waiting = [tuple(range(len(blocking.bodies)))]
    within: tuple[int, ...] = ()
    while waiting:
        rest = list(waiting.pop())
        while rest and not stop():
            rest = _leave_singly(blocking, rest, within, steps, stop)
            group = _smallest_group(blocking, rest, stop) if rest else None
            if group is not None:
                steps.append(RemovalStep(group[0], (group[1],), within))
                waiting.append(group[0])
                rest = [body for body in rest if body not in group[0]]
                continue
            path = _first_path(blocking, rest, stop) if rest and paths else None
            if path is not None:
                steps.append(RemovalStep((path[0],), path[1], within))
                rest.remove(path[0])
            elif rest and not stop():
                locked.append(tuple(rest))
                rest = []
        if stop():
            return RemovalOrder(tuple(steps), tuple(locked), tuple(sorted({*rest, *sum(waiting, ())})))
        within = waiting[-1] if waiting else ()
    return RemovalOrder(tuple(steps), tuple(locked))


def _leave_singly(
    blocking: Blocking,
    rest: Sequence[int],
    within: tuple[int, ...],
    steps: list[RemovalStep],
    stop: Callable[[], bool],
) -> list[int]:
    """Take out single bodies as long as one can leave; add the steps, and return the bodies that remain."""
    size = np.prod(blocking.high - blocking.low, axis=1)
    left = dict.fromkeys(sorted(rest, key=lambda body: -float(blocking.high[body, 2])))
    blockers: dict[tuple[int, int], int] = {}
    directions = len(blocking.directions)

    def leaving(bodies: Sequence[int], ways: Sequence[int]) -> Iterator[tuple[int, int]]:
        tried = ((body, k) for body in bodies for k in ways)
        return ((body, k) for body, k in tried if not stop() and _leaves(blocking, body, k, left, blockers))

    found = True
    while left and found:
        ways = list(leaving(list(left), (0,)))
        ways = ways or list(
            islice(leaving(sorted(left, key=lambda body: float(size[body])), range(1, directions)), 1)
        )
        steps += [RemovalStep((body,), (_without_end(blocking.directions[k]),), within) for body, k in ways]
        found = bool(ways)
    return list(left)


def _without_end(direction: Floats) -> Motion:
    return tuple((direction + 0.0).tolist()), np.inf


def _leaves(
    blocking: Blocking, body: int, k: int, left: dict[int, None], blockers: dict[tuple[int, int], int]
) -> bool:
    """Take a body out of those that are left if none of them blocks it in direction k; tell whether it left."""
    if blockers.get((body, k)) in left:
        return False
    for other in blocking.candidates(body, np.array(list(left)), k).tolist():
        if blocking.is_blocked(body, other, k):
            blockers[body, k] = other
            return False
    del left[body]
    return True


def _smallest_group(
    blocking: Blocking, rest: Sequence[int], stop: Callable[[], bool]
) -> tuple[tuple[int, ...], Motion] | None:
    """Return the smallest group of fewer than all bodies that can leave in a direction, and its motion; or None.

    Of many bodies, a group of at most a quarter is small enough, so that further directions are not asked for.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    best: tuple[tuple[int, ...], Motion] | None = None
    bodies = np.array(rest)
    place = {body: index for index, body in enumerate(rest)}
    for k, direction in enumerate(blocking.directions):
        arcs = [
            (place[body], place[other])
            for body in rest
            if not stop()
            for other in blocking.candidates(body, bodies, k).tolist()
            if blocking.is_blocked(body, other, k)
        ]
        if stop():
            return None
        tails, heads = np.array(arcs, np.int64).reshape(-1, 2).T
        graph = coo_array((np.ones(len(arcs)), (tails, heads)), shape=(len(rest), len(rest)))
        count, component = connected_components(graph, directed=True, connection="strong")
        blocked = np.isin(np.arange(count), component[tails[component[tails] != component[heads]]])
        sizes = np.where(blocked, len(rest), np.bincount(component, minlength=count))
        chosen = int(sizes.argmin())
        if sizes[chosen] < (len(rest) if best is None else len(best[0])):
            group = tuple(bodies[component == chosen].tolist())
            best = group, _without_end(direction)
        if best is not None and len(best[0]) <= max(2, len(rest) // 4):
            break
    return best


def with_blockers(blocking: Blocking, order: RemovalOrder) -> RemovalOrder:
    """Return an order in which each step of one motion out of the build has the bodies after which it is possible.

    The order is returned as it is if there are more than `MOST_PAIRS` pairs of bodies to compare.
    """
    steps = order.steps
    gone: list[int] = []
    met: dict[int, list[int]] = {}
    for number, step in enumerate(steps):
        if len(step.bodies) == len(step.path) == 1 and not step.within:
            met[number] = blocking.candidates(
                step.bodies[0], np.array(gone, np.int64), _number(blocking, step)
            ).tolist()
        gone += () if step.within else step.bodies
    if sum(map(len, met.values())) > MOST_PAIRS:
        return order
    completed = (
        replace(step, after=_blockers(blocking, step, met[number])) if number in met else step
        for number, step in enumerate(steps)
    )
    return replace(order, steps=tuple(completed))


def _blockers(blocking: Blocking, step: RemovalStep, others: Sequence[int]) -> tuple[int, ...]:
    k = _number(blocking, step)
    return tuple(other for other in others if blocking.is_blocked(step.bodies[0], other, k))


def _number(blocking: Blocking, step: RemovalStep) -> int:
    """Return the number of the direction of a step of one motion."""
    return int((blocking.directions @ np.array(step.path[0][0])).argmax())


def _first_path(
    blocking: Blocking, rest: Sequence[int], stop: Callable[[], bool]
) -> tuple[int, tuple[Motion, ...]] | None:
    """Return the first of some bodies, smallest first, for which a path away from the others is found, and the path."""
    size = np.prod(blocking.high - blocking.low, axis=1)
    bodies = sorted(rest, key=lambda each: float(size[each]))
    for body in bodies[:1] if len(bodies) == 2 else bodies:
        path = find_path(blocking, body, [other for other in rest if other != body], stop)
        if path is not None:
            return body, path
    return None
