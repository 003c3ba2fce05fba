"""The router `min-cost-flow`: as many paths as fit, at the least cost (thesis 3.3)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int32s, Int64s
from amprep.flows.escalation import escalate
from amprep.flows.network import FlowProblem, cost_overflow, flow_problem_of, narrow_zero_flow
from amprep.flows.plans import exact_plan
from amprep.kernels.flow.min_cost import (
    NO_EXIT,
    TOO_FAR,
    TOO_HIGH,
    EdgeCosts,
    Exits,
    Potentials,
    SearchArrays,
    augment_shortest,
    search_nearest_exit,
)
from amprep.kernels.flow.records import UNREACHABLE, Flow, ResidualNetwork
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem

_FAR_16_BIT = 1 << 14
"""Potential of states without a path to the plate, as long as 16 bits are enough for all other potentials."""

_WORTH_A_ROUND = 4
"""Units found by a round of augmentation from which another round costs less than one search for each unit."""

_BUCKETS_16_BIT = 4000
"""Number of buckets below which 16 bits are enough for the distances of several searches."""

_INITIAL_BUCKETS = 1 << 16
"""Greatest number of buckets at the beginning; a search that needs more gets more."""


class MinCostFlow(NamedTuple):
    """A flow, and the potentials that prove that it is optimal.

    Attributes
    ----------
    potential
        ``(2 * squares,)`` distance to the plate in the residual network, of each square's in and out state.
    connected
        ``(m,)`` the red squares that have a path.
    """

    task: FlowProblem
    flow: Flow
    potential: Int32s
    connected: Bools
    stop_reason: str


def route_min_cost_flow(problem: SupportProblem, *, stop: Stop, progress: Progress) -> SupportPlan:
    """Connect as many red squares as the capacities allow, at the least sum of all edges' costs.

    Exact, unless it is stopped: then the flow is of least cost for the red squares that it connects.
    """
    solved = solve_min_cost_flow(problem, stop=stop, progress=progress)
    cost = float(cost_of(solved.task, solved.flow))
    return exact_plan(
        solved.task, solved.flow, solved.connected, objective=cost, stop_reason=solved.stop_reason
    )


def cost_of(task: FlowProblem, flow: Flow) -> int:
    """Return the cost of a flow: units times the problem's costs, summed over all edges."""
    used = np.flatnonzero(flow.square)
    vertical, *oblique = flow.edge[used].sum(axis=0, dtype=np.int64).tolist()
    return int(vertical * task.problem.costs[0] + sum(oblique) * task.problem.costs[1])


def solve_min_cost_flow(problem: SupportProblem, *, stop: Stop, progress: Progress) -> MinCostFlow:
    """Return a maximum flow of least cost, with potentials.

    In the first phase the plate is the exit, and every reachable red square is to send one unit. The red squares
    that cannot are in a region from which no residual path leads to the plate. They share it with connected red
    squares, some of which it may be cheaper to leave out instead. So in the second phase the exits are the
    connected red squares, at the cost that leaving each out saves. Both phases together solve the same problem as
    one with an arc of high cost from every red square to the plate.

    If capacities may be raised, a maximum flow first finds which ones, and the first phase starts again.
    """
    solver = _PrimalDual(flow_problem_of(problem))
    stop_reason = solver.connect(stop, progress)
    if stop_reason == "finished":
        flow = Flow(*(each.copy() for each in solver.flow))
        task, _, stop_reason = escalate(solver.task, flow, solver.connected, stop=stop, progress=progress)
        if task.capacities is not solver.task.capacities and stop_reason == "finished":
            solver = _PrimalDual(task)
            stop_reason = solver.connect(stop, progress)
    if stop_reason == "finished":
        stop_reason = solver.exchange(stop, progress)
    potential = solver.potential.astype(np.int32)
    potential[np.repeat(solver.task.distance == UNREACHABLE, 2)] = UNREACHABLE
    return MinCostFlow(solver.task, solver.flow, potential, solver.connected, stop_reason)


class _PrimalDual:
    """The moving state: flow, potentials, and which red squares send their unit."""

    def __init__(self, task: FlowProblem) -> None:
        self.task = task
        self.flow = narrow_zero_flow(task)
        self.potential = _narrow(task.distance)
        self.connected = np.zeros(len(task.start), np.bool_)
        self.costs = EdgeCosts(*task.problem.costs)
        buckets = 4 * task.network.box.shape[0] * max(task.problem.costs) + 16
        self.work = _search_arrays(self.potential.size, min(buckets, _INITIAL_BUCKETS))
        self._last_number = 0

    def connect(self, stop: Stop, progress: Progress) -> str:
        """Send units to the plate until no more can get there; return why it ended."""
        exits = self._exits(np.arange(self.task.network.stride), 0, once=False)
        left = np.flatnonzero(self.task.reachable)
        left = left[np.argsort(self.task.start[left], kind="stable")]
        distance = 0
        while left.size and distance != NO_EXIT:
            distance, left = self._serve(exits, left)
            self.connected = self.task.reachable.copy()
            self.connected[left] = False
            if stop():
                return stop.reason
            progress(1.0 - left.size / self.connected.size, "connecting demand squares")
        return "finished"

    def exchange(self, stop: Stop, progress: Progress) -> str:
        """Leave out the red squares that save most, instead of the last ones; return why it ended."""
        left = np.flatnonzero(self.task.reachable & ~self.connected)
        count = left.size
        if not count:
            return "finished"
        before = Flow(self.flow.edge.copy(), self.flow.square.copy())
        exits = self._exits(self.task.start[self.task.reachable], self._highest_potential(), once=True)
        while left.size:
            _, left = self._serve(exits, left)
            if stop():
                self.flow = before
                return stop.reason
            progress(1.0 - left.size / count, "choosing demand squares to leave out")
        self.connected = self.task.reachable & (exits.state[self.task.start] == 1)
        return "finished"

    def _exits(self, squares: Int64s, level: int, *, once: bool) -> Exits:
        exits = Exits(np.zeros(self.task.network.passable.size, np.uint8), level, once)
        exits.state[squares] = 1
        return exits

    def _highest_potential(self) -> int:
        """Return the greatest potential of a reachable red square."""
        return int(self.potential[2 * self.task.start[self.task.reachable]].max())

    @property
    def _residual(self) -> ResidualNetwork:
        return ResidualNetwork(self.task.network, self.flow, self.task.capacities)

    def _serve(self, exits: Exits, left: Int64s) -> tuple[int, Int64s]:
        """Send units over shortest paths of the known length, then search on; return as `_search` does.

        A round of augmentation overlooks paths through states that it has closed itself. If it has overlooked
        many, another round finds them; a few are found one by one by searches, which then return 0.
        """
        served = _WORTH_A_ROUND
        while left.size and served >= _WORTH_A_ROUND:
            count = left.size
            left = self._augment(exits, left)
            served = count - left.size
        distance, singles = 0, 0
        while left.size and distance == 0 and singles < _WORTH_A_ROUND:
            distance, left = self._search(exits, left)
            singles += 1
        return distance, left

    def _augment(self, exits: Exits, left: Int64s) -> Int64s:
        """Send units over paths of reduced cost 0; return the red squares that are left."""
        ends, number = np.empty(left.size, np.int64), self._next_number(1)
        arguments = (self._residual, self.costs, self.potential, exits, self.task.start[left])
        augment_shortest(*arguments, ends, self.work, number)
        return left[ends < 0]

    def _search(self, exits: Exits, left: Int64s) -> tuple[int, Int64s]:
        """Send one unit over a shortest path; return its reduced cost and the red squares that are left."""
        start, lift = self.task.start[left], self._highest_potential() + 1
        while True:
            number = self._next_number(self.work.bucket.size)
            highest = _FAR_16_BIT - 1 if self.potential.dtype == np.int16 else UNREACHABLE - 1
            arguments = (self._residual, self.costs, self.potential, exits, start)
            distance, served = search_nearest_exit(*arguments, lift, highest, self.work, number)
            if distance == TOO_HIGH:
                if self.potential.dtype != np.int16:
                    raise cost_overflow(self.task.problem)
                self.potential = self.potential.astype(np.int32)
                continue
            if distance != TOO_FAR:
                return distance, left[start != served]
            states, buckets, entries = self.potential.size, self.work.bucket.size, self.work.entry.size
            self.work = _search_arrays(states, 4 * buckets, 2 * entries)
            self._last_number = 0

    def _next_number(self, span: int) -> int:
        """Return a number greater than all entries of ``work.seen``; reserve it and the next `span`."""
        number = self._last_number + 1
        self._last_number = number + span
        if self._last_number >= np.iinfo(self.work.seen.dtype).max:
            self.work.seen[:] = 0
            number, self._last_number = 1, 1 + span
        return number


def _narrow(distance: Int32s) -> Potentials:
    """Return the distance of both states of each square, in 16 bits if these are enough: they are faster."""
    if distance.max(where=distance < UNREACHABLE, initial=0) < _FAR_16_BIT:
        return np.repeat(np.minimum(distance, _FAR_16_BIT).astype(np.int16), 2)
    return np.repeat(distance, 2)


def _search_arrays(states: int, buckets: int, entries: int | None = None) -> SearchArrays:
    """Return work arrays; a search may put a state in buckets more than once."""
    entries = 2 * states + 16 if entries is None else entries
    return SearchArrays(
        seen=np.zeros(states, np.int16) if buckets < _BUCKETS_16_BIT else np.zeros(states, np.int32),
        stack=np.empty(states, np.int32),
        arc=np.empty(states, np.uint8),
        visited=np.empty(states, np.int32),
        bucket=np.empty(buckets, np.int32),
        entry=np.empty(entries, np.int32),
        below=np.empty(entries, np.int32),
    )
