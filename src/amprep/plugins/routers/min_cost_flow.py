"""The router `min-cost-flow`: as many paths as fit, at the least cost (thesis 3.3)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int32s, Int64s
from amprep.flows.escalation import escalate
from amprep.flows.network import Task, exact_plan, nothing_carried, task_of, uncountable
from amprep.kernels.flow.min_cost import (
    NO_EXIT,
    TOO_FAR,
    TOO_HIGH,
    Exits,
    Potentials,
    Prices,
    Search,
    augment,
    search,
)
from amprep.kernels.flow.residual import UNREACHED, Carried
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem

_CLOSED = 1 << 14
"""Potential of states without a way, as long as 16 bits are enough for all others."""

_WORTH = 4
"""Units that are worth another round of augmenting rather than a search for each."""

_FEW = 4000
"""Buckets up to which 16 bits are enough for the distances of several searches."""


_MANY = 1 << 16
"""Buckets to begin with, at most; a search that needs more gets more."""


class MinCostFlow(NamedTuple):
    """A flow with the potentials that prove it.

    Attributes
    ----------
    potential
        ``(2 * squares,)`` distance to the plate in the residual network, of each square's in and out state.
    connected
        ``(m,)`` bool, the red squares that have a path.
    """

    task: Task
    carried: Carried
    potential: Int32s
    connected: Bools
    stop_reason: str


def route_min_cost_flow(problem: SupportProblem, *, stop: Stop, progress: Progress) -> SupportPlan:
    """Connect as many red squares as the capacities allow and make the sum of all edges' costs least.

    Exact, unless stopped: then what has been connected so far is of least cost for those red squares.
    """
    solved = solve_min_cost_flow(problem, stop=stop, progress=progress)
    done = solved.stop_reason == "finished"
    return exact_plan(
        solved.task,
        solved.carried,
        solved.connected,
        status="optimal" if done else "feasible",
        stop_reason=solved.stop_reason,
        objective=float(cost_of(solved.task, solved.carried)),
    )


def cost_of(task: Task, carried: Carried) -> int:
    """Return the cost of a flow: units times the problem's costs, summed over all edges."""
    used = np.flatnonzero(carried.through)
    straight, *oblique = carried.flow[used].sum(axis=0, dtype=np.int64).tolist()
    return int(straight * task.problem.costs[0] + sum(oblique) * task.problem.costs[1])


def solve_min_cost_flow(problem: SupportProblem, *, stop: Stop, progress: Progress) -> MinCostFlow:
    """Return a flow of greatest value and least cost, with potentials.

    First the plate is the exit, and every red square with a way is to ship one unit. Those that then cannot
    are in a region from where the plate is out of reach, and share it with connected ones that would perhaps
    better be left out in their place: there the exits are the connected red squares, at the price of what
    each saves. This is the same problem as with an arc of high cost from every red square to the plate.
    When capacities may be raised, a greatest flow says first which ones, and all starts anew with these.
    """
    routing = _Routing(task_of(problem))
    stop_reason = routing.connect(stop, progress)
    if stop_reason == "finished":
        first = Carried(*(each.copy() for each in routing.carried))
        task, _, stop_reason = escalate(routing.task, first, routing.connected, stop=stop, progress=progress)
        if task.room is not routing.task.room and stop_reason == "finished":
            routing = _Routing(task)
            stop_reason = routing.connect(stop, progress)
    if stop_reason == "finished":
        stop_reason = routing.exchange(stop, progress)
    potential = routing.potential.astype(np.int32)
    potential[np.repeat(routing.task.distance == UNREACHED, 2)] = UNREACHED
    return MinCostFlow(routing.task, routing.carried, potential, routing.connected, stop_reason)


class _Routing:
    """The moving state: flow, potentials, and which red squares ship their unit."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.carried = nothing_carried(task)
        self.potential = _narrow(task.distance)
        self.connected = np.zeros(len(task.start), np.bool_)
        self.prices = Prices(*task.problem.costs)
        buckets = 4 * task.network.box.shape[0] * max(task.problem.costs) + 16
        self.work = _work(self.potential.size, min(buckets, _MANY))
        self.number, self._last = 0, 0

    def connect(self, stop: Stop, progress: Progress) -> str:
        """Send units to the plate until no more can get there; return why it ended."""
        exits = self._exits(np.arange(self.task.network.stride), 0, once=False)
        left = np.flatnonzero(self.task.open)
        left = left[np.argsort(self.task.start[left], kind="stable")]
        distance = 0
        while left.size and distance != NO_EXIT:
            distance, left = self._serve(exits, left)
            self.connected = self.task.open.copy()
            self.connected[left] = False
            if stop():
                return stop.reason
            progress(1.0 - left.size / self.connected.size, "connecting red squares")
        return "finished"

    def exchange(self, stop: Stop, progress: Progress) -> str:
        """Leave those red squares out that save most, instead of those that came last; say why it ended."""
        left = np.flatnonzero(self.task.open & ~self.connected)
        count = left.size
        if not count:
            return "finished"
        before = Carried(self.carried.flow.copy(), self.carried.through.copy())
        exits = self._exits(self.task.start[self.task.open], self._highest(), once=True)
        while left.size:
            _, left = self._serve(exits, left)
            if stop():
                self.carried = before
                return stop.reason
            progress(1.0 - left.size / count, "choosing what to leave out")
        self.connected = self.task.open & (exits.open[self.task.start] == 1)
        return "finished"

    def _exits(self, squares: Int64s, level: int, *, once: bool) -> Exits:
        exits = Exits(np.zeros(self.task.network.via.size, np.uint8), level, once)
        exits.open[squares] = 1
        return exits

    def _highest(self) -> int:
        """Return the greatest potential of a red square with a way."""
        return int(self.potential[2 * self.task.start[self.task.open]].max())

    def _serve(self, exits: Exits, left: Int64s) -> tuple[int, Int64s]:
        """Send units as far away as the last search has found, then search on; return as `_search` does.

        A round of augmenting overlooks ways that it has closed itself: many are worth another round, a few are
        found one by one by searches, whose answer then is 0.
        """
        served = _WORTH
        while left.size and served >= _WORTH:
            count = left.size
            left = self._augment(exits, left)
            served = count - left.size
        distance, singles = 0, 0
        while left.size and distance == 0 and singles < _WORTH:
            distance, left = self._search(exits, left)
            singles += 1
        return distance, left

    def _augment(self, exits: Exits, left: Int64s) -> Int64s:
        """Send units over ways of no reduced cost; return the red squares that are left."""
        self._number(1)
        ends = np.empty(left.size, np.int64)
        state = (self.task.network, self.carried, self.task.room, self.prices, self.potential)
        augment(*state, exits, self.task.start[left], ends, self.work, self.number)
        return left[ends < 0]

    def _search(self, exits: Exits, left: Int64s) -> tuple[int, Int64s]:
        """Send one unit the shortest way; return its reduced cost and the red squares that are left."""
        state = (self.task.network, self.carried, self.task.room, self.prices, self.potential)
        start, lift = self.task.start[left], self._highest() + 1
        while True:
            self._number(self.work.heads.size)
            highest = _CLOSED - 1 if self.potential.dtype == np.int16 else UNREACHED - 1
            distance, served = search(*state, exits, start, lift, highest, self.work, self.number)
            if distance == TOO_HIGH:
                if self.potential.dtype != np.int16:
                    raise uncountable(self.task.problem)
                self.potential = self.potential.astype(np.int32)
                state = (*state[:-1], self.potential)
                continue
            if distance != TOO_FAR:
                return distance, left[start != served]
            self.work = _work(self.potential.size, 4 * self.work.heads.size, 2 * self.work.entry.size)
            self._last = 0

    def _number(self, span: int) -> None:
        """Take the next number that no entry of ``work.seen`` reaches; it and `span` more are free."""
        self.number = self._last + 1
        self._last = self.number + span
        if self._last >= np.iinfo(self.work.seen.dtype).max:
            self.work.seen[:] = 0
            self.number, self._last = 1, 1 + span


def _narrow(distance: Int32s) -> Potentials:
    """Return the distance of both states of each square, in 16 bits when these are enough: they are quicker."""
    if distance.max(where=distance < UNREACHED, initial=0) < _CLOSED:
        return np.repeat(np.minimum(distance, _CLOSED).astype(np.int16), 2)
    return np.repeat(distance, 2)


def _work(states: int, buckets: int, entries: int | None = None) -> Search:
    """Return work arrays; a search may put a state in buckets more than once."""
    entries = 2 * states + 16 if entries is None else entries
    return Search(
        seen=np.zeros(states, np.int16) if buckets < _FEW else np.zeros(states, np.int32),
        stack=np.empty(states, np.int32),
        arc=np.empty(states, np.uint8),
        done=np.empty(states, np.int32),
        heads=np.empty(buckets, np.int32),
        entry=np.empty(entries, np.int32),
        below=np.empty(entries, np.int32),
    )
