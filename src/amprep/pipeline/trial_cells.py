"""Tries a lattice cell: a table top in the air is supported by it, from the grid to the finished solids."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from amprep.checks.cells import check_bodies
from amprep.checks.templates import check_cells
from amprep.checks.violation import Violation
from amprep.hookspecs import CellEmitter
from amprep.host import Host, Listed
from amprep.model import (
    Build,
    BuildSettings,
    BuildVolume,
    CellRequest,
    Cells,
    Mesh,
    Part,
    PlacedPart,
    Stop,
    SupportPlan,
    SupportProblem,
    silent,
)
from amprep.model.control import Report
from amprep.pipeline.cells import build_supports
from amprep.pipeline.supports import SupportLayout, plan_supports
from amprep.pipeline.trial import SEED, Case
from amprep.pipeline.trial_problems import box_mesh

PITCH = 2.0


def cell_cases(host: Host, listed: Listed[CellEmitter]) -> Iterator[Case]:
    """Yield the cases of one cell: the templates by themselves, and supports made of them."""
    emit = _emitter(host, listed)
    for name, part in (("a table top", _slab(20.0, 12.0)), ("two storeys", _two_slabs())):
        layout = _layout(host, part)
        for surfaces in (True, False):
            words = f"{name}, {'walls without thickness allowed' if surfaces else 'solids only'}"
            run, judge = _building(layout, part, emit, surfaces)
            yield Case(words, run, judge, timed=False)


def _emitter(host: Host, listed: Listed[CellEmitter]) -> Callable[[CellRequest, Stop], Cells]:
    params = host.params(listed, {})
    return lambda request, stop: host.call(listed, request, params=params, stop=stop, report=silent)


def _building(
    layout: SupportLayout, part: PlacedPart, emit: Callable[[CellRequest, Stop], Cells], surfaces: bool
) -> tuple[Callable[[Stop], Any], Callable[[Any], Sequence[Violation]]]:
    """Return how to build the supports of `part`, and how to judge what was emitted and what was built."""

    def run(stop: Stop) -> tuple[list[tuple[CellRequest, Cells]], Any]:
        emitted: list[tuple[CellRequest, Cells]] = []

        def recorded(request: CellRequest) -> Cells:
            cells = emit(request, stop)
            emitted.append((request, cells))
            return cells

        bodies = build_supports(
            layout,
            (part,),
            recorded,
            overlap=0.1,
            connector="full",
            allow_surface=surfaces,
            stop=stop,
            report=silent,
        )
        return emitted, bodies

    def judge(answer: Any) -> list[Violation]:
        emitted, bodies = answer
        found = [violation for request, cells in emitted for violation in check_cells(request, cells)]
        if not bodies:
            found.append(Violation("supports", part.label, "expected supports, got none"))
        settings = BuildSettings("trial", _SPACE, reach=1.5 * PITCH)
        return [*found, *check_bodies(Build(settings, (part,), bodies), Stop())]

    return run, judge


_SPACE = BuildVolume(np.array([40.0, 40.0, 40.0]))


def _layout(host: Host, part: PlacedPart) -> SupportLayout:
    router = host.choose("router", "shortest-paths")
    params = host.params(router, {})

    def route(problem: SupportProblem, stop: Stop, report: Report) -> SupportPlan:
        rng = np.random.default_rng(SEED)
        return host.call(router, problem, params=params, rng=rng, stop=stop, report=report)

    return plan_supports((part,), _SPACE, route=route, pitch=PITCH, stop=Stop(), report=silent)


def _slab(side: float, height: float) -> PlacedPart:
    return _placed("slab", box_mesh(np.array([8.0, 8, height]), np.array([8 + side, 8 + side, height + 3.0])))


def _two_slabs() -> PlacedPart:
    """Return a slab above a smaller one: the supports of the upper one have to go around the lower one."""
    lower = box_mesh(np.array([14.0, 14, 8]), np.array([22.0, 22, 10]))
    upper = box_mesh(np.array([10.0, 10, 24]), np.array([26.0, 26, 26]))
    vertices = np.concatenate([lower.vertices, upper.vertices])
    return _placed("slabs", Mesh(vertices, np.concatenate([lower.triangles, upper.triangles + 8])))


def _placed(name: str, mesh: Mesh) -> PlacedPart:
    return PlacedPart(name, Part(name, mesh, mesh.signed_volume), np.eye(4))
