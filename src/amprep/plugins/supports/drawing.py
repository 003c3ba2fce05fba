"""Paths drawn on the grid, taken back and drawn again: the moving state of `shortest-paths` and `tree`."""

from collections.abc import Iterator

import numpy as np

from amprep.kernels.flow_network import Carried
from amprep.kernels.routing import (
    FAR,
    UNBOUNDED,
    Limits,
    Longs,
    Prices,
    draw,
    erase,
    redo,
    sweep,
)
from amprep.kernels.routing_augment import Work, augment, untangle
from amprep.model.arrays import Bools
from amprep.model.control import Report, Stop
from amprep.model.supports import CAPACITY, ENCLOSED, SupportPlan, SupportProblem
from amprep.plugins.supports.escalation import escalate
from amprep.plugins.supports.exact import task_of
from amprep.plugins.supports.network import hard_limits, network_of, no_flows, plan_of
from amprep.plugins.supports.params import ShortestPathsParams
from amprep.plugins.supports.pushing import push

_EFFORT = 20_000_000
"""Arcs that augmenting searches may look at in one go; a fraction of a second."""


class Drawing:
    """The moving state: paths, their flows, and the limits in force.

    `costs` are those of a straight and of an oblique edge with one path, the problem's own when None.
    """

    def __init__(
        self,
        problem: SupportProblem,
        params: ShortestPathsParams,
        costs: tuple[float, float] | None = None,
    ) -> None:
        self.problem, self.params = problem, params
        self.network, self.start = network_of(problem)
        self.flows = no_flows(self.network)
        self.first = np.concatenate([[0], np.cumsum(problem.red[:, 0], dtype=np.int64)])
        self.ways = np.zeros(int(self.first[-1]), np.uint8)
        self.drawn = np.zeros(len(self.start), np.uint8)
        self.batch = 0
        capacities = problem.node_capacity or problem.edge_capacity or not params.paths_per_square
        self.soft = not capacities
        soft = Limits(params.paths_per_square, params.paths_per_square, UNBOUNDED)
        self.limits = soft if self.soft else hard_limits(problem)
        self.plain = self._prices((1.0,), 0.0, problem.costs)
        self.price(params.g, params.neighbour_discount, costs or problem.costs)
        sweep(self.network, self.flows, self.plain, Limits(UNBOUNDED, UNBOUNDED, UNBOUNDED))
        np.logical_and(self.network.via, self.flows.entry < FAR, out=self.network.via.view(np.bool_))
        ends = self.start[:, None] - self.network.stride + self.network.offset
        self.open = np.flatnonzero((self.flows.entry[ends] < FAR).any(axis=1))

    def price(self, g: tuple[float, ...], discount: float, costs: tuple[float, float]) -> None:
        """Set what edges cost when paths are redrawn."""
        self.shared = self._prices(g, discount, costs)

    def _prices(self, g: tuple[float, ...], discount: float, costs: tuple[float, float]) -> Prices:
        """Continue the last slope of `g` for as many paths as there can be."""
        count = min(len(self.start), UNBOUNDED) + 2
        slope = g[-1] - g[-2] if len(g) > 1 else 0.0
        beyond = g[-1] + slope * np.arange(1, max(count - len(g), 0) + 1)
        table = np.maximum(np.concatenate([g, beyond]), 0.0).astype(np.float32)
        straight, oblique = costs
        return Prices(table, np.float32(straight), np.float32(oblique), np.float32(1.0 - discount))

    def connect_all(self) -> None:
        """Draw the first paths, by the plain costs; raise soft limits until every open red square has one."""
        self._draw(self.open, self.plain)
        while self._lost().size and (self.soft or self.problem.escalation == "uniform"):
            self.limits = _grown(self.limits, self.soft)
            self._draw(self._lost(), self.plain)

    def adopt(self, carried: Carried, connected: Bools) -> None:
        """Take over the paths of a flow instead; soft limits become as great as it needs."""
        self.drawn[:] = connected
        flowing = self.flows._replace(flow=carried.flow.astype(np.uint16))
        untangle(self.network, flowing, self.start, self.first, self.ways, self.drawn)
        self.drawn[:] = 0
        self._redo(np.flatnonzero(connected))
        if self.soft:
            most = max(self.limits.square, int(carried.through.max(initial=0)))
            self.limits = Limits(most, most, UNBOUNDED)

    @property
    def lost(self) -> int:
        """Number of open red squares without a path."""
        return len(self._lost())

    @property
    def material(self) -> float:
        """Material of all edges in use, mm3."""
        return float(self.flows.used @ self.problem.material)

    def choices(self, rng: np.random.Generator) -> Iterator[Longs]:
        """Yield the red squares of each round: slices of random orders of all that are open."""
        size = max(1, round(len(self.open) * self.params.redraw_ratio))
        order = np.empty(0, np.int64)
        for _ in range(self.params.rounds if len(self.open) else 0):
            while len(order) < size:
                order = np.concatenate([order, rng.permutation(self.open)])
            yield order[:size]
            order = order[size:]

    def redraw(self, chosen: Longs) -> None:
        """Take the chosen paths back and draw them anew at the present prices."""
        lost = self._lost()
        self._erase(chosen)
        self._draw(np.concatenate([lost, chosen]), self.shared)

    def improve(self, chosen: Longs) -> bool:
        """Redraw the chosen paths if all find a way and no more material is used; tell whether they were."""
        before, ways = self.material, self.ways.copy()
        chosen = chosen[self.drawn[chosen] == 1]
        self._erase(chosen)
        if not self._try(chosen, self.shared) and self.material <= before:
            return True
        self._erase(chosen)
        self.ways = ways
        self._redo(chosen)
        return False

    def _erase(self, chosen: Longs) -> None:
        erase(self.network, self.flows, self.start, chosen, self.first, self.ways, self.drawn)

    def _redo(self, chosen: Longs) -> None:
        redo(self.network, self.flows, self.start, chosen, self.first, self.ways, self.drawn)

    def _draw(self, chosen: Longs, prices: Prices) -> None:
        if self._try(chosen, prices):
            self._augment()

    def _try(self, chosen: Longs, prices: Prices) -> int:
        """Draw the chosen paths; return how many found no way."""
        self.batch += 1
        sweep(self.network, self.flows, prices, self.limits)
        failed: int = draw(
            self.network,
            self.flows,
            prices,
            self.limits,
            self.start,
            chosen,
            self.first,
            self.ways,
            self.drawn,
            self.batch,
        )
        return failed

    def _lost(self) -> Longs:
        lost: Longs = self.open[self.drawn[self.open] == 0]
        return lost

    def _augment(self) -> None:
        states = 2 * self.network.via.size
        work = Work(
            np.zeros(states, np.int32),
            np.empty(states, np.int32),
            np.empty(states, np.uint8),
            np.empty(states, np.int32),
        )
        augment(self.network, self.flows, self.limits, self.start, self._lost(), self.drawn, work, _EFFORT)
        untangle(self.network, self.flows, self.start, self.first, self.ways, self.drawn)

    def plan(self, stop_reason: str) -> SupportPlan:
        """Return the plan as drawn so far."""
        way = np.zeros(len(self.start), np.bool_)
        way[self.open] = True
        left = np.flatnonzero(self.drawn == 0)
        reasons = [(int(red), CAPACITY if way[red] else ENCLOSED) for red in left]
        return plan_of(self.problem, self.network, self.flows, reasons, stop_reason=stop_reason)

    def escalate(self, stop: Stop, report: Report) -> str:
        """Connect the red squares left over as far as there is room; return why it ended.

        First the flow is made as great as it can be, for the searches while drawing are cut short. Then
        capacities grow, if `problem.escalation` says so.
        """
        if not self._lost().size:
            return "finished"
        task, flowing = task_of(self.problem), Carried(self.flows.flow, self.flows.through)
        connected, stop_reason = push(task, flowing, self.drawn == 1, stop=stop, report=report)
        if stop_reason == "finished":
            _, connected, stop_reason = escalate(task, flowing, connected, stop=stop, report=report)
        self.drawn[:] = connected
        return stop_reason


def _grown(limits: Limits, soft: bool) -> Limits:
    """Return limits that grow by a quarter when they are soft, else by one."""
    if soft:
        square = limits.square + max(1, limits.square // 4)
        return Limits(square, square, UNBOUNDED)
    square, edge = (min(limit + 1, UNBOUNDED) for limit in (limits.square, limits.edge))
    return Limits(square, limits.ground, edge)
