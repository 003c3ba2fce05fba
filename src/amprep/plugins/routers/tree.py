"""The router `tree`: least material, by local search over merges from two good starts."""

from copy import deepcopy
from dataclasses import replace

import numpy as np

from amprep.arrays import Int64s
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.min_cost_flow import solve_min_cost_flow
from amprep.plugins.routers.params import ShortestPathsParams, TreeParams
from amprep.plugins.routers.path_state import Drawing

_G = (1.0, 0.02, 0.0, 0.0)
"""An edge in use costs next to nothing more: what counts is the material of new ones."""


def route_tree(
    problem: SupportProblem,
    *,
    params: TreeParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    """Use as little material as can be found; an edge in use costs `problem.material`, whatever its flow.

    Starts are what `shortest-paths` gives for the same `rng`, and a flow of least cost that is gathered in
    the same way; the better one is improved: again and again the paths of neighbouring red squares are taken
    back and drawn anew by the material that new edges would take, and this stays when no more is used in all.
    So the result never takes more than either start; the notes compare them. Capacities are treated as by
    `shortest-paths`.
    """
    stop = stop.within(params.seconds)
    gather = ShortestPathsParams(paths_per_square=params.paths_per_square)
    gathered = Drawing(problem, gather)
    gathered.connect_all(stop, silent)
    grown = Drawing(problem, gather, problem.material)
    flow = solve_min_cost_flow(_limited(problem, params), stop=stop, progress=silent)
    grown.adopt(flow)
    adopted = grown.material
    for drawing in (gathered, grown):
        _redraw(drawing, deepcopy(rng), stop)
    best = grown if (grown.lost, grown.material) < (gathered.lost, gathered.material) else gathered
    gathered_material = gathered.material
    if adopted < best.material and flow.connected.sum() >= best.drawn.sum():
        best = Drawing(problem, gather, problem.material)
        best.adopt(flow)
    best.price(_G, 0.0, problem.material)
    stop_reason = _improve(best, params, rng, stop, progress)
    note = (
        f"tree takes {best.material:.6g} mm3 of material: {_less(best.material, gathered_material)} "
        f"shortest-paths, {_less(best.material, adopted)} min-cost-flow"
    )
    if stop_reason == "finished":
        stop_reason = best.escalate(stop, progress)
    return replace(best.plan(stop_reason), notes=(note,) if best.drawn.any() else ())


def _limited(problem: SupportProblem, params: TreeParams) -> SupportProblem:
    """Return the problem with the capacities that the drawing keeps."""
    if problem.node_capacity or problem.edge_capacity or not params.paths_per_square:
        return replace(problem, escalation="uniform" if problem.escalation == "uniform" else "none")
    return replace(problem, node_capacity=params.paths_per_square, escalation="uniform")


def _redraw(drawing: Drawing, rng: np.random.Generator, stop: Stop) -> None:
    for chosen in drawing.choices(rng):
        if stop():
            return
        drawing.redraw(chosen)


def _improve(
    drawing: Drawing, params: TreeParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> str:
    """Redraw neighbours while it pays; return why it ended."""
    for done in range(params.rounds if len(drawing.open) else 0):
        if stop():
            return stop.reason
        drawing.improve(_neighbours(drawing, int(rng.choice(drawing.open)), params.neighbours))
        progress((done + 1) / params.rounds, "merging supports")
    return "finished"


def _neighbours(drawing: Drawing, red: int, count: int) -> Int64s:
    """Return the `count` red squares that are nearest to one, itself included, seen from above."""
    place = drawing.problem.red[drawing.open, 1:].astype(np.int64)
    away = ((place - drawing.problem.red[red, 1:]) ** 2).sum(axis=1)
    nearest: Int64s = drawing.open[np.argsort(away, kind="stable")[:count]]
    return nearest


def _less(material: float, other: float) -> str:
    return f"{100 * (1 - material / other):.1f} % less than" if other > 0 else "as much as"
