"""Compare the volume of our supports with straight columns of the same contact area and with PrusaSlicer."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.bench.prusaslicer import STYLES, sliced_support_volume
from amprep.host import Host, choose
from amprep.model import (
    BuildVolume,
    Mesh,
    Part,
    PlacedPart,
    Progress,
    Stop,
    SupportEdges,
    SupportPlan,
    SupportProblem,
    Voxel,
    silent,
)
from amprep.pipeline.reading import expand_inputs, read_all
from amprep.pipeline.resolve import cell_named
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.legs.cell import CellProperties
from amprep.supports.plan import PassScope, PlanningRules, Route, plan_supports
from amprep.supports.solids.build import SolidRules, build_supports

if TYPE_CHECKING:
    from manifold3d import Manifold

SPACE = BuildVolume(np.array([250.0, 210.0, 210.0]))


@dataclass(frozen=True)
class SupportVolumeResult:
    """Support volumes of one part (mm3).

    Attributes
    ----------
    contact_mm2
        Area in plan of the connected red squares. Only squares with a free column down to the plate count.
    routers
        Volume with each of our routers.
    straight
        Volume of straight columns of the same cells below the same squares.
    rivals
        Volume in PrusaSlicer by support style; None if there is none. PrusaSlicer chooses its own contact.
    """

    part: str
    contact_mm2: float
    routers: dict[str, float]
    straight: float
    rivals: dict[str, float | None]

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        fractions = {name: volume / self.straight for name, volume in self.routers.items() if self.straight}
        return {
            "part": self.part,
            "contact_mm2": self.contact_mm2,
            "amprep_mm3": self.routers,
            "straight_mm3": self.straight,
            "fraction_of_straight": fractions,
            "prusaslicer_mm3": self.rivals,
        }


def generated_parts() -> dict[str, Mesh]:
    """Return the generated parts, on the plate with their lower corner at x = y = 0."""
    from manifold3d import Manifold

    tilted = Manifold.cube((50, 30, 4)).rotate((0, 30, 0))
    solids = {
        "ball": Manifold.sphere(15.0, 96),
        "table": Manifold.cube((40, 40, 4)).translate((0, 0, 26))
        + Manifold.cube((6, 6, 28)).translate((17, 17, 0)),
        "bridge": Manifold.cube((60, 12, 4)).translate((0, 0, 20))
        + Manifold.cube((6, 12, 22))
        + Manifold.cube((6, 12, 22)).translate((54, 0, 0)),
        "hook": Manifold.cube((8, 12, 60)) + Manifold.cube((35, 12, 6)).translate((0, 0, 54)),
        "tilted plate": tilted,
    }
    return {name: _on_plate(solid) for name, solid in solids.items()}


def meshes_of(files: Sequence[Path], host: Host) -> dict[str, Mesh]:
    """Return the meshes of all parts in mesh files, moved onto the plate.

    Raises
    ------
    InputError, MeshError
        If a file cannot be read or a part is not a solid.
    """
    inputs = expand_inputs([(file, None) for file in files], host.suffixes)
    parts = read_all(inputs, lambda path: host.read(path, {}, {}))
    return {part.name: Mesh(part.mesh.vertices - part.mesh.bounds[0], part.mesh.triangles) for part in parts}


def _on_plate(solid: "Manifold") -> Mesh:
    mesh = solid.to_mesh()
    points = np.asarray(mesh.vert_properties[:, :3], np.float64)
    return Mesh(points - points.min(axis=0), mesh.tri_verts)


def compare(
    name: str,
    mesh: Mesh,
    host: Host,
    *,
    routers: Sequence[str],
    cell: str,
    pitch: float,
    slicer: Path | None,
    stop: Stop,
) -> SupportVolumeResult:
    """Support a part with each router, with straight columns and in PrusaSlicer.

    Parameters
    ----------
    name, mesh
        The part, on the plate.
    host
        The plugin host.
    routers, cell
        Names of the routers and of the lattice cell.
    pitch
        Grid pitch (mm).
    slicer
        PrusaSlicer's executable; None to leave it out.
    stop
        Asked by each stage.
    """
    size = mesh.bounds[1] - mesh.bounds[0]
    matrix = np.eye(4)
    matrix[:3, 3] = [*np.round((SPACE.size[:2] - size[:2]) / 2), 0.0] - mesh.bounds[0]
    part = PlacedPart(name, Part(name, mesh, mesh.signed_volume), matrix)
    volumes = {each: _volume(part, host, _router(host, each), cell, pitch, stop) for each in routers}
    straight, squares = _volume(part, host, straight_columns, cell, pitch, stop)
    return SupportVolumeResult(
        name,
        squares * pitch * pitch,
        {each: volume for each, (volume, _) in volumes.items()},
        straight,
        {
            style: None if slicer is None else sliced_support_volume(slicer, part.mesh, style)
            for style in STYLES
        },
    )


def straight_columns(problem: SupportProblem, stop: Stop, progress: Progress) -> SupportPlan:  # noqa: ARG001
    """Route each red square straight down; all voxels below it must be free."""
    top = int(problem.red[:, 0].max(initial=0))
    flow = np.zeros((top + 1, *problem.voxels.shape[1:]), np.int32)
    for plane, y, x in problem.red.tolist():
        flow[1 : plane + 1, y, x] += 1
    plane, y, x = (each.astype(np.int32) for each in flow.nonzero())
    load = flow[plane, y, x]
    return SupportPlan(SupportEdges(plane, y, x, np.zeros(len(plane), np.uint8), load, load))


def free_below(voxels: Bytes, red: RedSquares) -> Bools:
    """Return which red squares have only free voxels below them, as ``(n,)`` booleans."""
    blocked = np.cumsum(voxels != Voxel.FREE, axis=0)
    plane, y, x = red.square.T
    return np.asarray((plane > 0) & (blocked[np.maximum(plane, 1) - 1, y, x] == 0))


def _router(host: Host, name: str) -> Route:
    router = choose(host, "router", name, {})
    return lambda problem, stop, progress: router.call(
        problem, rng=np.random.default_rng(0), stop=stop, progress=progress
    )


def _volume(
    part: PlacedPart, host: Host, route: Route, cell: str, pitch: float, stop: Stop
) -> tuple[float, int]:
    """Return the volume of the finished supports (mm3) and the number of red squares connected."""
    emitter = cell_named(host, cell)
    layout = plan_supports(
        (part,),
        SPACE,
        PlanningRules(pitch_mm=pitch),
        route=route,
        cell=CellProperties(emitter.material(pitch, pitch)),
        scope=PassScope(choose=free_below),
        stop=stop,
        progress=silent,
    )
    bodies = build_supports(
        layout,
        (part,),
        lambda request: emitter.emit(request, stop=stop),
        SolidRules(),
        stop=stop,
        progress=silent,
    )
    return sum(abs(body.mesh.signed_volume) for body in bodies), int(layout.connected.sum())
