"""Run support routers on generated scenes at the sizes of the thesis and check each plan independently."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.bench.memory import peak_mb, reset_peak
from amprep.bench.routing.rivals import RIVALS, Rival
from amprep.checks.supports.plan import check_plan, check_raises
from amprep.host import Host
from amprep.model import Stop, silent
from amprep.model.supports import Escalation, SupportPlan, SupportProblem
from amprep.model.supports.edges import square_keys
from amprep.testing.support_scenes import SIDES, count_graph, support_scene

if TYPE_CHECKING:
    from amprep.hookspecs import SupportRouter
    from amprep.host import Listed

THESIS_SECONDS = {
    "push-relabel": dict(zip(SIDES, (0.002, 0.007, 0.027, 0.664, 6.75), strict=True)),
    "min-cost-flow": dict(zip(SIDES, (0.017, 0.089, 0.133, 12.1, 186.0), strict=True)),
    "shortest-paths": dict(zip(SIDES, (0.092, 0.325, 0.948, 20.73, 142.0), strict=True)),
}
"""Running times of the thesis (chapter 4, seconds) by router and size."""

_INITIAL = {"rounds": 0, "paths_per_square": 0}
"""Parameters with which `shortest-paths` returns its initial paths, before any is rerouted."""

_MAX_SQUARES_FOR_RAISES = 100_000
"""Largest number of squares for which the check of raised capacities is run."""


@dataclass(frozen=True)
class RoutingResult:
    """The plan of a router, or the flow of another solver, in figures.

    Attributes
    ----------
    nodes, edges
        Numbers of squares of the grid and of edges between them.
    red_squares, connected
        Number of red squares, and of those that are connected.
    seconds
        Processor time of routing alone, after a warm-up run; None if a solver did not run.
    cost
        Sum of flow times cost over all edges.
    squares_initial, squares_final
        Number of squares in use; `squares_initial` before rerouting, None for routers that do not reroute.
    max_paths_per_square
        Largest number of paths in a square, including those on the plate.
    capacity_raised
        Largest amount that escalation added to a capacity.
    material
        Material of the edges in use.
    peak_mb
        Peak memory of the process (MiB); None where the system does not tell.
    validated
        True if the independent check found no violation; for another solver, if its values equal ours.
    time_ratio
        Processor time of another solver over that of our router.
    notes
        Notes of the router, or the reason why a solver did not run.
    """

    router: str
    scene: str
    size: str
    capacity: int
    nodes: int
    edges: int
    red_squares: int
    seconds: float | None
    thesis_seconds: float | None = None
    connected: int | None = None
    cost: int | None = None
    squares_initial: int | None = None
    squares_final: int | None = None
    max_paths_per_square: int | None = None
    capacity_raised: int | None = None
    material: float | None = None
    status: str | None = None
    peak_mb: int | None = None
    validated: bool | None = None
    time_ratio: float | None = None
    notes: tuple[str, ...] = ()

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        seconds = {} if self.seconds is None else {"seconds": round(self.seconds, 4)}
        return asdict(self) | seconds

    @property
    def line(self) -> str:
        """The result in one line."""
        name = f"{self.router}, {self.scene} {self.size}"
        if self.seconds is None:
            return f"{name}: {', '.join(self.notes)}"
        verdict = {True: "valid", False: "INVALID", None: ""}[self.validated]
        parts = [
            f"{self.seconds:.3f} s" + _format(" (thesis {:g} s)", self.thesis_seconds),
            _format("{:.1f} times our time", self.time_ratio),
            f"{self.connected} of {self.red_squares} red squares connected",
            _format("cost {}", self.cost),
            _format("capacities raised by up to {}", self.capacity_raised or None),
            _format("{} squares used", self.squares_final)
            + _format(" ({} before rerouting)", self.squares_initial),
            _format("at most {} paths per square", self.max_paths_per_square),
            _format("material {:g}", self.material),
            _format("peak memory {} MB", self.peak_mb),
            verdict,
        ]
        return f"{name}: " + ", ".join(filter(None, parts)) + "".join(f"\n  {note}" for note in self.notes)


def _format(text: str, value: float | None) -> str:
    """Return the text with the value filled in, or nothing without a value."""
    return "" if value is None else text.format(value)


def run_scene(
    routers: Sequence[str],
    name: str,
    size: str,
    *,
    capacity: int,
    seed: int,
    escalation: Escalation = "none",
    rivals: bool = False,
) -> Iterator[RoutingResult]:
    """Run routers on a scene and yield their results, then those of other solvers.

    Each router runs twice and the second run is measured. Other solvers run once.

    Parameters
    ----------
    routers
        Names of the routers.
    name, size
        The scene, and its size, A to E.
    capacity
        Capacity of each square; 0 for no limit. Edges have no limit.
    seed
        Seed of the routers' random numbers.
    escalation
        How capacities are raised if red squares stay unconnected.
    rivals
        Run OR-tools, scipy and networkx on the same scene.

    Raises
    ------
    PluginError
        If a router is unknown or fails.
    """
    host = Host.load()
    chosen = [host.choose("router", router) for router in routers]
    problem = replace(support_scene(name, SIDES[size], capacity=capacity), escalation=escalation)
    nodes, edges = count_graph(problem)
    blank = RoutingResult("", name, size, capacity, nodes, edges, len(problem.red), None)
    ours = {}
    for listed in chosen:
        result = run_router(host, listed, problem, seed, blank)
        ours[result.router] = result
        yield result
    for rival in RIVALS if rivals else ():
        if rival.router in ours:
            yield _run_rival(rival, problem, ours[rival.router], replace(blank, router=rival.name))


def run_router(
    host: Host,
    listed: "Listed[SupportRouter]",
    problem: SupportProblem,
    seed: int,
    blank: RoutingResult,
    *,
    warm: bool = False,
) -> RoutingResult:
    """Route a problem and return the measured and judged plan.

    Parameters
    ----------
    blank
        Result with the name and the figures of the scene.
    warm
        Whether everything is compiled: then the router runs once, and initial paths are not counted.
    """
    name, size = listed.offer.name, blank.size
    initial = None
    if not warm:
        initial = _route(host, listed, problem, seed, _INITIAL) if name == "shortest-paths" else None
        _route(host, listed, problem, seed, {})
    reset_peak()
    start = time.process_time()
    plan = _route(host, listed, problem, seed, {})
    took = time.process_time() - start
    peak = peak_mb()
    wrong = check_plan(problem, plan)
    if blank.nodes <= _MAX_SQUARES_FOR_RAISES:
        wrong += check_raises(problem, plan)
    return replace(
        blank,
        router=name,
        seconds=took,
        thesis_seconds=THESIS_SECONDS.get(name, {}).get(size),
        connected=len(problem.red) - len(plan.unconnected),
        cost=_cost(problem, plan),
        squares_initial=None if initial is None else _squares(initial),
        squares_final=_squares(plan),
        max_paths_per_square=_max_paths_per_square(plan),
        capacity_raised=plan.raised,
        material=_material(problem, plan),
        status=plan.status,
        peak_mb=peak,
        validated=not wrong,
        notes=plan.notes,
    )


def _run_rival(
    rival: Rival, problem: SupportProblem, ours: RoutingResult, blank: RoutingResult
) -> RoutingResult:
    if problem.escalation != "none":
        return replace(blank, notes=("not run: it does not raise capacities",))
    if blank.nodes > rival.max_squares:
        return replace(blank, notes=(f"not run: takes minutes for more than {rival.max_squares} squares",))
    if find_spec(rival.package) is None:
        return replace(blank, notes=(f"not run: the package {rival.package} is not installed",))
    reset_peak()
    flow, cost, took = rival.solve(problem)
    same = flow == ours.connected and cost in (None, ours.cost)
    ratio = took / ours.seconds if ours.seconds else None
    peak = peak_mb()
    return replace(
        blank, seconds=took, connected=flow, cost=cost, peak_mb=peak, validated=same, time_ratio=ratio
    )


def _route(
    host: Host, listed: "Listed[SupportRouter]", problem: SupportProblem, seed: int, table: dict[str, Any]
) -> SupportPlan:
    rng, params = np.random.default_rng(seed), host.params(listed, table)
    return host.call(listed, problem, params=params, rng=rng, stop=Stop(), progress=silent)


def _cost(problem: SupportProblem, plan: SupportPlan) -> int:
    cost = np.array(problem.costs)[np.minimum(plan.edges.direction, 1)]
    return int((cost * plan.edges.flow.astype(np.int64)).sum())


def _material(problem: SupportProblem, plan: SupportPlan) -> float:
    """Return the material of all edges in use, mm3 in the chosen cell."""
    return float(np.array(problem.material)[np.minimum(plan.edges.direction, 1)].sum())


def _squares(plan: SupportPlan) -> int:
    """Return the number of squares from which an edge in use leads down."""
    return len(np.unique(square_keys(plan.edges.upper)))


def _max_paths_per_square(plan: SupportPlan) -> int:
    """Return the largest number of paths that leave a square or arrive at one."""
    most = 0
    for squares in (plan.edges.upper, plan.edges.lower):
        _, square = np.unique(square_keys(squares), return_inverse=True)
        most = max(most, int(np.bincount(square, weights=plan.edges.flow).max(initial=0)))
    return most
