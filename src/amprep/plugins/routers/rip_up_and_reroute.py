"""Rip up and reroute: the moving state of the routers `shortest-paths` and `tree`."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from amprep.arrays import Int64s
from amprep.flows.augmentation import Augmentation
from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import maximise_flow
from amprep.flows.network import FlowProblem, build_network, flow_problem_of, zero_flow
from amprep.flows.plans import plan_from_flow
from amprep.kernels.flow.paths import decompose, restore, rip_up
from amprep.kernels.flow.records import UNBOUNDED, Capacities, FlowNetwork
from amprep.kernels.flow.shortest_paths import (
    FAR,
    EdgePrices,
    PathLimits,
    Paths,
    RoutingState,
    route,
    sweep,
)
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.min_cost_flow import MinCostFlow
from amprep.plugins.routers.params import ShortestPathsParams


class Routing:
    """Paths, the flow that they make up, and the limits in force.

    Without capacities in the problem, `params.paths_per_square` is a soft limit: it grows until every reachable
    red square has a path.

    Parameters
    ----------
    costs
        Costs of a vertical and of an oblique edge with one path; the problem's own costs if None.

    Attributes
    ----------
    reachable
        ``(k,)`` numbers of the red squares from which a path leads to the plate.
    """

    def __init__(
        self,
        problem: SupportProblem,
        params: ShortestPathsParams,
        costs: tuple[float, float] | None = None,
    ) -> None:
        self.problem, self.params = problem, params
        self.network, start = build_network(problem)
        self.state = _initial_state(self.network, len(start))
        self.flow = self.state.flow
        self.paths = _no_paths(problem, start)
        self.batch = 0
        self.has_soft_limit = not (
            problem.node_capacity or problem.edge_capacity or not params.paths_per_square
        )
        self.limits = (
            _soft_limits(params.paths_per_square)
            if self.has_soft_limit
            else PathLimits(_equal(problem.node_capacity, problem.edge_capacity), UNBOUNDED)
        )
        self.plain_prices = self._prices((1.0,), 0.0, problem.costs)
        self.set_prices(params.g, params.neighbour_discount, costs or problem.costs)
        self.reachable = self._find_reachable()

    def _find_reachable(self) -> Int64s:
        """Return the reachable red squares; make squares impassable from which no path leads to the plate."""
        passable, distance = self.network.passable, self.state.distance
        sweep(self.network, self.state, self.plain_prices, PathLimits(_equal(), UNBOUNDED))
        np.logical_and(passable, distance < FAR, out=passable.view(np.bool_))
        ends = self.paths.start[:, None] - self.network.stride + self.network.offset
        return np.flatnonzero((distance[ends] < FAR).any(axis=1))

    def set_prices(self, g: tuple[float, ...], discount: float, costs: tuple[float, float]) -> None:
        """Set the prices of edges for rerouting."""
        self.prices = self._prices(g, discount, costs)

    def _prices(self, g: tuple[float, ...], discount: float, costs: tuple[float, float]) -> EdgePrices:
        """Return prices by a table of `g` whose last slope continues for as many paths as there can be."""
        count = min(len(self.paths.start), UNBOUNDED) + 2
        slope = g[-1] - g[-2] if len(g) > 1 else 0.0
        beyond = g[-1] + slope * np.arange(1, max(count - len(g), 0) + 1)
        table = np.maximum(np.concatenate([g, beyond]), 0.0).astype(np.float32)
        vertical, oblique = costs
        return EdgePrices(table, np.float32(vertical), np.float32(oblique), np.float32(1.0 - discount))

    def connect_all(self, stop: Stop, progress: Progress) -> None:
        """Route the first paths at plain prices; raise limits until every reachable red square has one, if allowed.

        Where capacities are raised, all paths are routed again, as if the problem had had them from the start: those
        that the smaller capacities had led around a full square may be long.
        """
        self._route(self.reachable, self.plain_prices)
        while self.has_soft_limit and self._unrouted().size and not stop():
            self.limits = _soft_limits(self.limits.plate + max(1, self.limits.plate // 4))
            self._route(self._unrouted(), self.plain_prices)
        may_raise = not self.has_soft_limit and self.problem.escalation != "none"
        if may_raise and self.unrouted_count and self._raise_capacities(stop, progress):
            rip_up(self.network, self.state, self.paths, self.reachable)
            self._route(self.reachable, self.plain_prices)

    def _raise_capacities(self, stop: Stop, progress: Progress) -> bool:
        """Raise capacities for the unrouted red squares as `problem.escalation` says; tell whether it finished."""
        connected = self.paths.routed == 1
        self._task, connected, stop_reason = escalate(
            self._task, self.flow, connected, stop=stop, progress=progress
        )
        self.paths.routed[:] = connected
        self.limits = self.limits._replace(capacities=self._task.capacities)
        self._read_paths()
        return stop_reason == "finished"

    def adopt(self, solved: MinCostFlow) -> None:
        """Replace all paths by those of a minimum-cost flow, and the limits by those that it keeps."""
        self.paths.routed[:] = solved.connected
        self.flow.edge[:], self.flow.square[:] = solved.flow
        self._read_paths()
        if self.has_soft_limit:
            self.limits = _soft_limits(max(self.limits.plate, int(self.flow.square.max(initial=0))))
        else:
            self._task = self._task._replace(capacities=solved.task.capacities)
            self.limits = self.limits._replace(capacities=solved.task.capacities)

    @property
    def unrouted_count(self) -> int:
        """Number of reachable red squares without a path."""
        return len(self._unrouted())

    @property
    def material(self) -> float:
        """Material of all edges in use, mm3."""
        return float(self.state.edges_used @ self.problem.material)

    def batches(self, rng: np.random.Generator) -> Iterator[Int64s]:
        """Yield the red squares to reroute in each round: slices of random orders of all reachable ones."""
        size = max(1, round(len(self.reachable) * self.params.reroute_ratio))
        order = np.empty(0, np.int64)
        for _ in range(self.params.rounds if len(self.reachable) else 0):
            while len(order) < size:
                order = np.concatenate([order, rng.permutation(self.reachable)])
            yield order[:size]
            order = order[size:]

    def reroute(self, chosen: Int64s) -> None:
        """Rip up the paths of the chosen red squares, and route them and all unrouted ones at the present prices."""
        unrouted = self._unrouted()
        rip_up(self.network, self.state, self.paths, chosen)
        self._route(np.concatenate([unrouted, chosen]), self.prices)

    def improve(self, chosen: Int64s) -> None:
        """Reroute the chosen red squares; undo it unless all find a path and no more material is used."""
        material, directions = self.material, self.paths.direction.copy()
        chosen = chosen[self.paths.routed[chosen] == 1]
        rip_up(self.network, self.state, self.paths, chosen)
        if not self._try_route(chosen, self.prices) and self.material <= material:
            return
        rip_up(self.network, self.state, self.paths, chosen)
        self.paths = self.paths._replace(direction=directions)
        restore(self.network, self.state, self.paths, chosen)

    def _route(self, chosen: Int64s, prices: EdgePrices) -> None:
        """Route paths of the chosen red squares; if some find none, augment the flow to a maximum flow."""
        if self._try_route(chosen, prices):
            self._augment()

    def _try_route(self, chosen: Int64s, prices: EdgePrices) -> int:
        """Route paths of the chosen red squares; return the number of those that found none."""
        self.batch += 1
        sweep(self.network, self.state, prices, self.limits)
        return int(route(self.network, self.state, prices, self.limits, self.paths, chosen, self.batch))

    def _unrouted(self) -> Int64s:
        return np.asarray(self.reachable[self.paths.routed[self.reachable] == 0])

    def _augment(self) -> None:
        """Augment the flow to a maximum flow within the limits; this may redirect any path."""
        if self.has_soft_limit:
            self._augment_within_limits()
        else:
            routed = self.paths.routed == 1
            routed, _ = maximise_flow(self._task, self.flow, routed, stop=Stop(), progress=silent)
            self.paths.routed[:] = routed
        self._read_paths()

    @cached_property
    def _task(self) -> FlowProblem:
        """The problem within its capacities, for maximum flow and escalation."""
        return flow_problem_of(self.problem)

    def _augment_within_limits(self) -> None:
        """Augment one by one: soft limits bind squares of the plate too, and leave only few red squares out."""
        plate = self.limits.plate - self.flow.square[: self.network.stride].astype(np.int32)
        augmentation, served = Augmentation(self.network, self.flow, plate), np.ones(1, np.bool_)
        while served.any():
            unrouted = self._unrouted()
            served, _ = augmentation.augment(self.limits.capacities, self.paths.start[unrouted])
            self.paths.routed[unrouted[served]] = 1

    def _read_paths(self) -> None:
        """Read the paths from a flow that has changed; count flow on the plate and mark all repriced squares."""
        decompose(self.network, self.flow, self.paths)
        (edge, square), stride, width = self.flow, self.network.stride, self.network.width
        square[:stride] = 0
        lowest = stride + np.flatnonzero(square[stride : 2 * stride])
        for direction, step in enumerate(self.network.offset):
            square[lowest - stride + step] += edge[lowest, direction]
        used = np.flatnonzero(square)
        for step in (0, 1, -1, width, -width):
            self.state.repriced[used + step] = 1
            self.state.repriced_rows[(used + step) // width] = 1
        vertical, *oblique = np.count_nonzero(edge[used], axis=0).tolist()
        self.state.edges_used[:] = vertical, sum(oblique)

    def plan(self, stop_reason: str) -> SupportPlan:
        """Return the plan of the present paths."""
        reachable = np.zeros(len(self.paths.start), np.bool_)
        reachable[self.reachable] = True
        connected = self.paths.routed == 1
        return plan_from_flow(
            self.problem, self.network, self.flow, connected, reachable, stop_reason=stop_reason
        )


def _equal(square: int = 0, edge: int = 0) -> Capacities:
    """Return the same capacities everywhere; 0 is no limit."""
    return Capacities(np.array([square or UNBOUNDED], np.int32), np.array([edge or UNBOUNDED], np.int32), 0)


def _soft_limits(paths_per_square: int) -> PathLimits:
    return PathLimits(_equal(paths_per_square), paths_per_square)


def _initial_state(network: FlowNetwork, most: int) -> RoutingState:
    """Return the state without paths, for up to `most` paths."""
    squares = network.passable.size
    return RoutingState(
        flow=zero_flow(network, most),
        repriced=np.zeros(squares, np.uint8),
        repriced_rows=np.zeros(squares // network.width, np.uint8),
        distance=np.full(squares, FAR, np.float32),
        dead_end=np.zeros(squares, np.int32),
        edges_used=np.zeros(2, np.int64),
    )


def _no_paths(problem: SupportProblem, start: Int64s) -> Paths:
    """Return room for a path of every red square: one direction a plane."""
    first = np.concatenate([[0], np.cumsum(problem.red[:, 0], dtype=np.int64)])
    directions, routed = np.zeros(int(first[-1]), np.uint8), np.zeros(len(start), np.uint8)
    return Paths(start, first, directions, routed)
