"""The router `min-cost-flow`: as many paths as fit, at the least cost (thesis 3.3)."""

from typing import NamedTuple

import numpy as np

from amprep.kernels.flow_min_cost import NO_EXIT, TOO_FAR, Exits, Prices, Search, augment, search
from amprep.kernels.flow_network import Carried
from amprep.kernels.routing import Ints, Longs
from amprep.model.arrays import Bools
from amprep.model.control import Report, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.supports.exact import Task, exact_plan, nothing_carried, task_of


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
    potential: Ints
    connected: Bools
    stop_reason: str


def route_min_cost_flow(problem: SupportProblem, *, stop: Stop, report: Report) -> SupportPlan:
    """Connect as many red squares as the capacities allow and make the sum of all edges' costs least.

    Exact, unless stopped: then what has been connected so far is of least cost for those red squares.
    """
    solved = solve_min_cost_flow(problem, stop=stop, report=report)
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


def solve_min_cost_flow(problem: SupportProblem, *, stop: Stop, report: Report) -> MinCostFlow:
    """Return a flow of greatest value and least cost, with potentials.

    First the plate is the exit, and every red square with a way is to ship one unit. Those that then cannot
    are in a region from where the plate is out of reach, and share it with connected ones that would perhaps
    better be left out in their place: there the exits are the connected red squares, at the price of what
    each saves. This is the same problem as with an arc of high cost from every red square to the plate.
    """
    routing = _Routing(task_of(problem))
    stop_reason = routing.connect(stop, report)
    if stop_reason == "finished":
        stop_reason = routing.exchange(stop, report)
    return MinCostFlow(routing.task, routing.carried, routing.potential, routing.connected, stop_reason)


class _Routing:
    """The moving state: flow, potentials, and which red squares ship their unit."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.carried = nothing_carried(task)
        self.potential = np.repeat(task.distance, 2)
        self.connected = np.zeros(len(task.start), np.bool_)
        self.prices = Prices(*task.problem.costs)
        states = self.potential.size
        self.work = Search(
            seen=np.zeros(states, np.int32),
            mark=np.zeros((states, 4), np.int32),
            stack=np.empty(states, np.int32),
            arc=np.empty(states, np.uint8),
            done=np.empty(states, np.int32),
        )
        self.number = 0
        self.heads = np.empty(4 * task.network.box.shape[0] * max(task.problem.costs) + 16, np.int32)

    def connect(self, stop: Stop, report: Report) -> str:
        """Send units to the plate until no more can get there; return why it ended."""
        exits = self._exits(np.arange(self.task.network.stride), 0, once=False)
        left = np.flatnonzero(self.task.open)
        left = left[np.argsort(self.task.start[left], kind="stable")]
        while left.size:
            ends = self._augment(exits, left)
            self.connected[left] = ends >= 0
            left = left[ends < 0]
            if stop():
                return stop.reason
            report(1.0 - left.size / self.connected.size, "connecting red squares")
            if (ends < 0).all() and self._search(exits, left) == NO_EXIT:
                break
        return "finished"

    def exchange(self, stop: Stop, report: Report) -> str:
        """Leave those red squares out that save most, instead of those that came last; say why it ended."""
        left = np.flatnonzero(self.task.open & ~self.connected)
        count = left.size
        if not count:
            return "finished"
        before = Carried(self.carried.flow.copy(), self.carried.through.copy())
        exits = self._exits(self.task.start[self.task.open], self._highest(), once=True)
        while left.size:
            ends = self._augment(exits, left)
            left = left[ends < 0]
            if stop():
                self.carried = before
                return stop.reason
            report(1.0 - left.size / count, "choosing what to leave out")
            if (ends < 0).all():
                self._search(exits, left)
        self.connected = self.task.open & (exits.open[self.task.start] == 1)
        return "finished"

    def _exits(self, squares: Longs, level: int, *, once: bool) -> Exits:
        exits = Exits(np.zeros(self.task.network.via.size, np.uint8), level, once)
        exits.open[squares] = 1
        return exits

    def _highest(self) -> int:
        """Return the greatest potential of a red square with a way."""
        return int(self.potential[2 * self.task.start[self.task.open]].max())

    def _augment(self, exits: Exits, left: Longs) -> Longs:
        self.number += 1
        ends = np.empty(left.size, np.int64)
        state = (self.task.network, self.carried, self.task.room, self.prices, self.potential)
        augment(*state, exits, self.task.start[left], ends, self.work, self.number)
        return ends

    def _search(self, exits: Exits, left: Longs) -> int:
        state = (self.task.network, self.carried, self.task.room, self.prices, self.potential)
        while True:
            self.number += 1
            start, lift = self.task.start[left], self._highest() + 1
            found: int = search(*state, exits, start, self.heads, lift, self.work, self.number)
            if found != TOO_FAR:
                return found
            self.heads = np.empty(4 * self.heads.size, np.int32)
