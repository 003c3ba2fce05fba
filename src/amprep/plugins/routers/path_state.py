"""Paths drawn on the grid, taken back and drawn again: the moving state of `shortest-paths` and `tree`."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from amprep.arrays import Int64s
from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import push
from amprep.flows.minimum_cut import Extender
from amprep.flows.network import Task, hard_limits, network_of, no_flows, plan_of, reasons_of, task_of
from amprep.kernels.flow.paths import erase, redo, untangle
from amprep.kernels.flow.residual import Carried, Room
from amprep.kernels.flow.shortest_paths import FAR, UNBOUNDED, Limits, Prices, draw, sweep
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.min_cost_flow import MinCostFlow
from amprep.plugins.routers.params import ShortestPathsParams


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
        self.flows = no_flows(self.network, len(self.start))
        self.first = np.concatenate([[0], np.cumsum(problem.red[:, 0], dtype=np.int64)])
        self.ways = np.zeros(int(self.first[-1]), np.uint8)
        self.drawn = np.zeros(len(self.start), np.uint8)
        self.batch = 0
        capacities = problem.node_capacity or problem.edge_capacity or not params.paths_per_square
        self.soft = not capacities
        self.carried = Carried(self.flows.flow, self.flows.through)
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

    def connect_all(self, stop: Stop, progress: Progress) -> None:
        """Draw the first paths, by the plain costs; raise limits until every open red square has one, if allowed."""
        self._draw(self.open, self.plain)
        while self.soft and self._lost().size and not stop():
            square = self.limits.square + max(1, self.limits.square // 4)
            self.limits = Limits(square, square, UNBOUNDED)
            self._draw(self._lost(), self.plain)
        if self.problem.escalation == "uniform" and not self.soft:
            self.escalate(stop, progress)

    def adopt(self, solved: MinCostFlow) -> None:
        """Take over the paths of a flow instead, and the limits that it keeps."""
        self.drawn[:] = solved.connected
        self.flows.flow[:], self.flows.through[:] = solved.carried
        self._follow()
        room = solved.task.room
        square, edge = int(room.square[0]), int(room.edge[0])
        if self.soft:
            square = max(self.limits.square, int(self.flows.through.max(initial=0)))
        self.limits = Limits(square, square if self.soft else UNBOUNDED, edge)

    @property
    def lost(self) -> int:
        """Number of open red squares without a path."""
        return len(self._lost())

    @property
    def material(self) -> float:
        """Material of all edges in use, mm3."""
        return float(self.flows.used @ self.problem.material)

    def choices(self, rng: np.random.Generator) -> Iterator[Int64s]:
        """Yield the red squares of each round: slices of random orders of all that are open."""
        size = max(1, round(len(self.open) * self.params.redraw_ratio))
        order = np.empty(0, np.int64)
        for _ in range(self.params.rounds if len(self.open) else 0):
            while len(order) < size:
                order = np.concatenate([order, rng.permutation(self.open)])
            yield order[:size]
            order = order[size:]

    def redraw(self, chosen: Int64s) -> None:
        """Take the chosen paths back and draw them anew at the present prices."""
        lost = self._lost()
        self._erase(chosen)
        self._draw(np.concatenate([lost, chosen]), self.shared)

    def improve(self, chosen: Int64s) -> bool:
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

    def _erase(self, chosen: Int64s) -> None:
        erase(self.network, self.flows, self.start, chosen, self.first, self.ways, self.drawn)

    def _redo(self, chosen: Int64s) -> None:
        redo(self.network, self.flows, self.start, chosen, self.first, self.ways, self.drawn)

    def _draw(self, chosen: Int64s, prices: Prices) -> None:
        if self._try(chosen, prices):
            self._extend()

    def _try(self, chosen: Int64s, prices: Prices) -> int:
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

    def _lost(self) -> Int64s:
        lost: Int64s = self.open[self.drawn[self.open] == 0]
        return lost

    def _extend(self) -> None:
        """Make the flow as great as it can be within the limits; it may redirect any path."""
        if self.soft:
            self._extend_softly()
        else:
            connected, _ = push(self._task, self.carried, self.drawn == 1, stop=Stop(), progress=silent)
            self.drawn[:] = connected
        self._follow()

    @cached_property
    def _task(self) -> Task:
        """The problem within its capacities; `push` and `escalate` work on the flows drawn here."""
        return task_of(self.problem)

    def _extend_softly(self) -> None:
        """Serve who can be: limits bind squares of the plate too, and few are left out by them."""
        square, edge = (np.array([limit], np.int32) for limit in (self.limits.square, self.limits.edge))
        ground = self.limits.ground - self.flows.through[: self.network.stride].astype(np.int32)
        extender, served = Extender(self.network, self.carried, ground), np.ones(1, np.bool_)
        while served.any():
            lost = self._lost()
            served, _ = extender.extend(Room(square, edge, 0), self.start[lost])
            self.drawn[lost[served]] = 1

    def _follow(self) -> None:
        """Find the paths in a flow that has changed, count those on the plate, note whose prices may change."""
        untangle(self.network, self.flows, self.start, self.first, self.ways, self.drawn)
        flow, through, stride, width = (
            self.flows.flow,
            self.flows.through,
            self.network.stride,
            self.network.width,
        )
        through[:stride] = 0
        low = stride + np.flatnonzero(through[stride : 2 * stride])
        for direction, step in enumerate(self.network.offset):
            through[low - stride + step] += flow[low, direction]
        used = np.flatnonzero(through)
        for step in (0, 1, -1, width, -width):
            self.flows.special[used + step] = 1
            self.flows.rows[(used + step) // width] = 1
        straight, *oblique = np.count_nonzero(flow[used], axis=0).tolist()
        self.flows.used[:] = straight, sum(oblique)

    def plan(self, stop_reason: str) -> SupportPlan:
        """Return the plan as drawn so far."""
        way = np.zeros(len(self.start), np.bool_)
        way[self.open] = True
        reasons = reasons_of(self.drawn == 1, way, stop_reason)
        return plan_of(self.problem, self.network, self.flows, reasons, stop_reason=stop_reason)

    def escalate(self, stop: Stop, progress: Progress) -> str:
        """Raise capacities for the red squares left over, if `problem.escalation` says so; return why it ended."""
        if not self._lost().size:
            return "finished"
        connected = self.drawn == 1
        task, connected, stop_reason = escalate(
            self._task, self.carried, connected, stop=stop, progress=progress
        )
        self.drawn[:] = connected
        if not task.room.each:
            self._task = task
            self.limits = Limits(int(task.room.square[0]), UNBOUNDED, int(task.room.edge[0]))
        self._follow()
        return stop_reason
