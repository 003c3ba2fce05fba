"""Runs support routers over generated scenes of the thesis's sizes; the judge looks at every plan."""

import sys
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.checks.supports import check_plan
from amprep.host import Host
from amprep.model import Stop, silent
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.pipeline.bench_supports_scenes import SIDES, count_graph, scene

if TYPE_CHECKING:
    from amprep.hookspecs import SupportRouter
    from amprep.host import Listed

THESIS_SECONDS = {
    "push-relabel": dict(zip(SIDES, (0.002, 0.007, 0.027, 0.664, 6.75), strict=True)),
    "min-cost-flow": dict(zip(SIDES, (0.017, 0.089, 0.133, 12.1, 186.0), strict=True)),
    "shortest-paths": dict(zip(SIDES, (0.092, 0.325, 0.948, 20.73, 142.0), strict=True)),
}
"""Router -> size -> seconds, of the table in chapter 4."""


@dataclass(frozen=True)
class Result:
    """What a router made of one scene.

    Attributes
    ----------
    nodes, edges
        All squares of the grid, and the edges that exist between them.
    seconds
        Of routing alone, after one run to warm up.
    flow
        Number of red squares connected, of `reds`.
    cost
        Sum over all edges of flow times the problem's cost.
    squares
        Number of squares in use.
    peak_mb
        Peak memory of the whole process so far; None where the system does not tell.
    validated
        Whether the judge found nothing.
    """

    router: str
    scene: str
    size: str
    capacity: int
    nodes: int
    edges: int
    reds: int
    seconds: float
    thesis_seconds: float | None
    flow: int
    cost: int
    squares: int
    status: str
    peak_mb: int | None
    validated: bool

    @property
    def record(self) -> dict[str, Any]:
        """The result as JSON can hold it."""
        return asdict(self) | {"seconds": round(self.seconds, 4)}

    @property
    def line(self) -> str:
        """The result in a line."""
        thesis = "" if self.thesis_seconds is None else f" (thesis {self.thesis_seconds:g} s)"
        memory = "memory unknown" if self.peak_mb is None else f"{self.peak_mb} MB"
        verdict = "valid" if self.validated else "INVALID"
        return (
            f"{self.router}, {self.scene} {self.size}: {self.seconds:.3f} s{thesis}, {self.flow} of "
            f"{self.reds} connected, cost {self.cost}, {self.squares} squares, {memory}, {verdict}"
        )


def run_scene(router: str, name: str, size: str, *, capacity: int, seed: int) -> Result:
    """Run a router on a scene, twice; the second run counts.

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
    listed = host.choose("router", router)
    problem = scene(name, SIDES[size], capacity=capacity)
    _route(host, listed, problem, seed)
    start = time.monotonic()
    plan = _route(host, listed, problem, seed)
    took = time.monotonic() - start
    peak = _peak_mb()
    nodes, edges = count_graph(problem)
    return Result(
        router,
        name,
        size,
        capacity,
        nodes,
        edges,
        len(problem.red),
        took,
        THESIS_SECONDS.get(router, {}).get(size),
        len(problem.red) - len(plan.unconnected),
        _cost(problem, plan),
        _squares(problem, plan),
        plan.status,
        peak,
        not check_plan(problem, plan),
    )


def _route(host: Host, listed: "Listed[SupportRouter]", problem: SupportProblem, seed: int) -> SupportPlan:
    rng, params = np.random.default_rng(seed), host.params(listed, {})
    return host.call(listed, problem, params=params, rng=rng, stop=Stop(), report=silent)


def _cost(problem: SupportProblem, plan: SupportPlan) -> int:
    return int((np.array(problem.costs)[np.minimum(plan.direction, 1)] * plan.flow.astype(np.int64)).sum())


def _squares(problem: SupportProblem, plan: SupportPlan) -> int:
    """Count the squares from which an edge in use leads down."""
    _, ny, nx = problem.cubes.shape
    return len(np.unique((plan.plane.astype(np.int64) * ny + plan.y) * nx + plan.x))


def _peak_mb() -> int | None:
    """Return the greatest memory this process has held; Linux counts in KiB, macOS in bytes."""
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return int(peak // (2**20 if sys.platform == "darwin" else 2**10))
