"""Sample problems for a lattice cell: support a table top with it, from the support grid to closed solids."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from amprep.checks.cells.templates import check_cells
from amprep.checks.supports.bodies import check_bodies
from amprep.checks.supports.coverage import check_coverage
from amprep.checks.violation import Violation
from amprep.host import Host
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
    silent,
)
from amprep.model.contacts import ConnectorRules
from amprep.supports.plan import PlanningRules, SupportLayout, plan_supports
from amprep.supports.solids.build import SolidRules, build_supports
from amprep.testing.case import Case
from amprep.testing.offers import LoadedOffer
from amprep.testing.problems import box_mesh

PITCH = 2.0
"""Pitch of the support grid (mm)."""


def cell_cases(offer: LoadedOffer) -> Iterator[Case]:
    """Yield the sample problems for a cell: supports of two shapes, with connectors and with extended cells."""
    for title, part in (("a table top", _slab(10.0, 12.0)), ("two storeys", _two_slabs())):
        layout = _layout(offer.host, part)
        for connector in (ConnectorRules("full"), ConnectorRules("extend")):
            run, judge = _building(layout, part, offer, connector)
            yield Case(f"{title}, connectors {connector.connector}", run, judge, timed=False)


def _building(
    layout: SupportLayout,
    part: PlacedPart,
    offer: LoadedOffer,
    connector: ConnectorRules,
) -> tuple[Callable[[Stop], Any], Callable[[Any], Sequence[Violation]]]:
    """Return a function that builds the supports of a part, and one that checks the cells and the bodies."""

    def run(stop: Stop) -> tuple[list[tuple[CellRequest, Cells]], Any]:
        emitted: list[tuple[CellRequest, Cells]] = []

        def recorded(request: CellRequest) -> Cells:
            cells: Cells = offer.run(request, stop=stop)
            emitted.append((request, cells))
            return cells

        bodies = build_supports(
            layout,
            (part,),
            recorded,
            SolidRules(connector=connector, allow_surface=True),
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
    router = LoadedOffer.of(host, host.choose("router", "shortest-paths"), {})
    return plan_supports(
        (part,),
        _SPACE,
        PlanningRules(pitch_mm=PITCH),
        route=lambda problem, stop, progress: router.run(problem, stop=stop, progress=progress),
        stop=Stop(),
        progress=silent,
    )


def _slab(side: float, height: float) -> PlacedPart:
    return _placed("slab", box_mesh(np.array([8.0, 8, height]), np.array([8 + side, 8 + side, height + 3.0])))


def _two_slabs() -> PlacedPart:
    """Return a slab above a smaller slab, around which the supports of the upper one must lead."""
    lower = box_mesh(np.array([12.0, 12, 4]), np.array([16.0, 16, 6]))
    upper = box_mesh(np.array([10.0, 10, 16]), np.array([18.0, 18, 18]))
    vertices = np.concatenate([lower.vertices, upper.vertices])
    return _placed("slabs", Mesh(vertices, np.concatenate([lower.triangles, upper.triangles + 8])))


def _placed(name: str, mesh: Mesh) -> PlacedPart:
    return PlacedPart(name, Part(name, mesh, mesh.signed_volume), np.eye(4))
