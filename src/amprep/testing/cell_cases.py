"""Tries a lattice cell: a table top in the air is supported by it, from the grid to the finished solids."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from amprep.checks.cells.templates import check_cells
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
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
from amprep.model.contacts import ConnectorRules
from amprep.model.control import Progress
from amprep.supports.plan import PlanningRules, SupportLayout, plan_supports
from amprep.supports.solids.build import build_supports
from amprep.testing.case import SEED, Case
from amprep.testing.problems import box_mesh

PITCH = 2.0


def cell_cases(host: Host, listed: Listed[CellEmitter]) -> Iterator[Case]:
    """Yield the cases of one cell: supports for two shapes, in each of the two ways they may end."""
    emit = _emitter(host, listed)
    for name, part in (("a table top", _slab(10.0, 12.0)), ("two storeys", _two_slabs())):
        layout = _layout(host, part)
        for connector in (ConnectorRules("full"), ConnectorRules("extend")):
            run, judge = _building(layout, part, emit, connector)
            yield Case(f"{name}, connectors {connector.connector}", run, judge, timed=False)


def _emitter(host: Host, listed: Listed[CellEmitter]) -> Callable[[CellRequest, Stop], Cells]:
    params = host.params(listed, {})
    return lambda request, stop: host.call(listed, request, params=params, stop=stop, progress=silent)


def _building(
    layout: SupportLayout,
    part: PlacedPart,
    emit: Callable[[CellRequest, Stop], Cells],
    connector: ConnectorRules,
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
            connector=connector,
            allow_surface=True,
            stop=stop,
            progress=silent,
        )
        return emitted, bodies

    def judge(answer: Any) -> list[Violation]:
        emitted, bodies = answer
        found = [violation for request, cells in emitted for violation in check_cells(request, cells)]
        if not bodies:
            found.append(Violation("supports", part.label, "expected supports, got none"))
        settings = BuildSettings("trial", _SPACE, reach=1.5 * PITCH)
        build = Build(settings, (part,), bodies)
        return [*found, *check_bodies(build, Stop()), *check_coverage(build)]

    return run, judge


_SPACE = BuildVolume(np.array([30.0, 30.0, 30.0]))


def _layout(host: Host, part: PlacedPart) -> SupportLayout:
    router = host.choose("router", "shortest-paths")
    params = host.params(router, {})

    def route(problem: SupportProblem, stop: Stop, progress: Progress) -> SupportPlan:
        rng = np.random.default_rng(SEED)
        return host.call(router, problem, params=params, rng=rng, stop=stop, progress=progress)

    return plan_supports(
        (part,), _SPACE, PlanningRules(pitch_mm=PITCH), route=route, stop=Stop(), progress=silent
    )


def _slab(side: float, height: float) -> PlacedPart:
    return _placed("slab", box_mesh(np.array([8.0, 8, height]), np.array([8 + side, 8 + side, height + 3.0])))


def _two_slabs() -> PlacedPart:
    """Return a slab above a smaller one: the supports of the upper one have to go around the lower one."""
    lower = box_mesh(np.array([12.0, 12, 4]), np.array([16.0, 16, 6]))
    upper = box_mesh(np.array([10.0, 10, 16]), np.array([18.0, 18, 18]))
    vertices = np.concatenate([lower.vertices, upper.vertices])
    return _placed("slabs", Mesh(vertices, np.concatenate([lower.triangles, upper.triangles + 8])))


def _placed(name: str, mesh: Mesh) -> PlacedPart:
    return PlacedPart(name, Part(name, mesh, mesh.signed_volume), np.eye(4))
