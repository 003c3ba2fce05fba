"""Runs support routers over generated scenes of the thesis's sizes; the judge looks at every plan."""

import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Int64s
from amprep.bench.routing.rivals import RIVALS, Rival
from amprep.bench.routing.scenes import SIDES, count_graph, scene
from amprep.checks.supports.plan import check_plan, check_raises
from amprep.host import Host
from amprep.model import Stop, silent
from amprep.model.supports import Escalation, SupportPlan, SupportProblem
from amprep.model.supports.edges import DIRECTIONS

if TYPE_CHECKING:
    from amprep.hookspecs import SupportRouter
    from amprep.host import Listed

THESIS_SECONDS = {
    "push-relabel": dict(zip(SIDES, (0.002, 0.007, 0.027, 0.664, 6.75), strict=True)),
    "min-cost-flow": dict(zip(SIDES, (0.017, 0.089, 0.133, 12.1, 186.0), strict=True)),
    "shortest-paths": dict(zip(SIDES, (0.092, 0.325, 0.948, 20.73, 142.0), strict=True)),
}
"""Router -> size -> seconds, of the table in chapter 4."""

_FIRST = {"rounds": 0, "paths_per_square": 0}
"""Parameters with which `shortest-paths` gives its first paths, shortest by the plain costs."""

_MOST_FOR_RAISES = 100_000
"""Squares up to which it is judged whether what escalation has raised was needed."""


@dataclass(frozen=True)
class Result:
    """What a router, or a rival, made of one scene.

    Attributes
    ----------
    nodes, edges
        All squares of the grid, and the edges that exist between them.
    seconds
        Of routing alone, after one run to warm up; of a rival's solving alone. None when it did not run.
    flow
        Number of red squares connected, of `reds`.
    cost
        Sum over all edges of flow times the problem's cost.
    squares_first, squares_final
        Number of squares in use; `squares_first` before any path was redrawn, None for other routers.
    most_in_a_square
        Greatest number of paths in any square, those on the plate included.
    raised
        The most that escalation has added to a capacity.
    peak_mb
        Peak memory of the whole process while it ran; None where the system does not tell.
    validated
        Whether the judge found nothing; for a rival, whether its value equals ours.
    times_ours
        Seconds of a rival over those of our router.
    notes
        What the router says, or why a rival did not run.
    """

    router: str
    scene: str
    size: str
    capacity: int
    nodes: int
    edges: int
    reds: int
    seconds: float | None
    thesis_seconds: float | None = None
    flow: int | None = None
    cost: int | None = None
    squares_first: int | None = None
    squares_final: int | None = None
    most_in_a_square: int | None = None
    raised: int | None = None
    material: float | None = None
    status: str | None = None
    peak_mb: int | None = None
    validated: bool | None = None
    times_ours: float | None = None
    notes: tuple[str, ...] = ()

    @property
    def record(self) -> dict[str, Any]:
        """The result as JSON can hold it."""
        seconds = {} if self.seconds is None else {"seconds": round(self.seconds, 4)}
        return asdict(self) | seconds

    @property
    def line(self) -> str:
        """The result in a line."""
        name = f"{self.router}, {self.scene} {self.size}"
        if self.seconds is None:
            return f"{name}: {', '.join(self.notes)}"
        said = [f"{self.seconds:.3f} s" + _maybe(" (thesis {:g} s)", self.thesis_seconds)]
        said.append(_maybe("{:.1f} times ours", self.times_ours))
        said.append(f"{self.flow} of {self.reds} connected")
        said.append(
            _maybe("cost {}", self.cost) + _maybe(", capacities raised by up to {}", self.raised or None)
        )
        first = _maybe(" after {}", self.squares_first)
        said.append(_maybe("{} squares" + first, self.squares_final))
        said.append(_maybe("at most {} paths in one", self.most_in_a_square))
        said.append(_maybe("material {:g}", self.material))
        said.append(_maybe("{} MB", self.peak_mb))
        said.append({True: "valid", False: "INVALID", None: ""}[self.validated])
        return f"{name}: " + ", ".join(filter(None, said)) + "".join(f"\n  {note}" for note in self.notes)


def _maybe(words: str, value: float | None) -> str:
    return "" if value is None else words.format(value)


def run_scene(
    routers: Sequence[str],
    name: str,
    size: str,
    *,
    capacity: int,
    seed: int,
    escalation: Escalation = "none",
    rivals: bool = False,
) -> Iterator[Result]:
    """Run routers on a scene, each twice; the second run counts. Rivals follow, each once.

    Parameters
    ----------
    capacity
        Of each square; 0 for none. Edges are unbounded.

    Raises
    ------
    PluginError
        For an unknown router, or one that fails.
    """
    host = Host.load()
    chosen = [host.choose("router", router) for router in routers]
    problem = replace(scene(name, SIDES[size], capacity=capacity), escalation=escalation)
    nodes, edges = count_graph(problem)
    blank = Result("", name, size, capacity, nodes, edges, len(problem.red), None)
    ours = {}
    for listed in chosen:
        result = _run(host, listed, problem, seed, blank)
        ours[result.router] = result
        yield result
    for rival in RIVALS if rivals else ():
        if rival.router in ours:
            yield _run_rival(rival, problem, ours[rival.router], replace(blank, router=rival.name))


def _run(
    host: Host, listed: "Listed[SupportRouter]", problem: SupportProblem, seed: int, blank: Result
) -> Result:
    name, size = listed.offer.name, blank.size
    first = _route(host, listed, problem, seed, _FIRST) if name == "shortest-paths" else None
    _route(host, listed, problem, seed, {})
    _forget_peak()
    start = time.monotonic()
    plan = _route(host, listed, problem, seed, {})
    took = time.monotonic() - start
    peak = peak_mb()
    wrong = check_plan(problem, plan)
    if blank.nodes <= _MOST_FOR_RAISES:
        wrong += check_raises(problem, plan)
    return replace(
        blank,
        router=name,
        seconds=took,
        thesis_seconds=THESIS_SECONDS.get(name, {}).get(size),
        flow=len(problem.red) - len(plan.unconnected),
        cost=_cost(problem, plan),
        squares_first=None if first is None else _squares(problem, first),
        squares_final=_squares(problem, plan),
        most_in_a_square=_most_in_a_square(problem, plan),
        raised=plan.raised,
        material=_material(problem, plan),
        status=plan.status,
        peak_mb=peak,
        validated=not wrong,
        notes=plan.notes,
    )


def _run_rival(rival: Rival, problem: SupportProblem, ours: Result, blank: Result) -> Result:
    if problem.escalation != "none":
        return replace(blank, notes=("raises no capacities",))
    if blank.nodes > rival.most_squares:
        return replace(blank, notes=(f"left out: takes minutes over {rival.most_squares} squares",))
    if find_spec(rival.package) is None:
        return replace(blank, notes=("not installed",))
    _forget_peak()
    flow, cost, took = rival.solve(problem)
    same = flow == ours.flow and cost in (None, ours.cost)
    times = took / ours.seconds if ours.seconds else None
    peak = peak_mb()
    return replace(blank, seconds=took, flow=flow, cost=cost, peak_mb=peak, validated=same, times_ours=times)


def _route(
    host: Host, listed: "Listed[SupportRouter]", problem: SupportProblem, seed: int, table: dict[str, Any]
) -> SupportPlan:
    rng, params = np.random.default_rng(seed), host.params(listed, table)
    return host.call(listed, problem, params=params, rng=rng, stop=Stop(), progress=silent)


def _cost(problem: SupportProblem, plan: SupportPlan) -> int:
    return int(
        (
            np.array(problem.costs)[np.minimum(plan.edges.direction, 1)] * plan.edges.flow.astype(np.int64)
        ).sum()
    )


def _material(problem: SupportProblem, plan: SupportPlan) -> float:
    """Return the material of all edges in use, mm3 in the chosen cell."""
    return float(np.array(problem.material)[np.minimum(plan.edges.direction, 1)].sum())


def _squares(problem: SupportProblem, plan: SupportPlan) -> int:
    """Count the squares from which an edge in use leads down."""
    return len(np.unique(_number(problem, plan, 0)))


def _most_in_a_square(problem: SupportProblem, plan: SupportPlan) -> int:
    """Return the greatest number of paths that leave a square, or that arrive at one."""
    most = 0
    for end in (0, 1):
        _, square = np.unique(_number(problem, plan, end), return_inverse=True)
        most = max(most, int(np.bincount(square, weights=plan.edges.flow).max(initial=0)))
    return most


def _number(problem: SupportProblem, plan: SupportPlan, end: int) -> Int64s:
    """Return the number of each edge's upper (0) or lower (1) square."""
    _, ny, nx = problem.voxels.shape
    step = end * np.array(DIRECTIONS, np.int64)[plan.edges.direction]
    plane = plan.edges.plane.astype(np.int64) - end
    return np.asarray((plane * ny + plan.edges.y + step[:, 0]) * nx + plan.edges.x + step[:, 1])


def _forget_peak() -> None:
    """Let the peak of this process start anew, where Linux can do that."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def peak_mb() -> int | None:
    """Return the greatest memory of this process since the last reset; None where the system does not tell."""
    with suppress(OSError):
        status = Path("/proc/self/status").read_text(encoding="ascii")
        return int(status.split("VmHWM:")[1].split()[0]) // 2**10
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak // (2**20 if sys.platform == "darwin" else 2**10))
