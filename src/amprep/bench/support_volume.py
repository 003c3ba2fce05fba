"""Benchmark: how much support amprep builds, against straight columns of the same contact and another slicer."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Bools, Bytes
from amprep.host import Host
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
from amprep.model.contacts import ConnectorRules
from amprep.pipeline.reading import expand_inputs, read_all
from amprep.stl import write_stl
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.plan import PlanningRules, Route, plan_supports
from amprep.supports.solids.build import build_supports

if TYPE_CHECKING:
    from manifold3d import Manifold
SPACE = BuildVolume(np.array([250.0, 210.0, 210.0]))


@dataclass(frozen=True)
class VolumeResult:
    """Support volumes of one part, mm3; None where there is no figure.

    Attributes
    ----------
    contact_mm2
        Area in plan of the red squares that were connected: those with nothing below them down to the plate.
    routers
        By each of amprep's routers.
    straight
        By a column of the same cells straight down from each of these squares.
    rivals
        By PrusaSlicer in each of its styles, with its own choice of contact.
    """

    part: str
    contact_mm2: float
    routers: dict[str, float]
    straight: float
    rivals: dict[str, float | None]

    @property
    def record(self) -> dict[str, Any]:
        """The result as plain values."""
        shares = {name: volume / self.straight for name, volume in self.routers.items() if self.straight}
        return {
            "part": self.part,
            "contact_mm2": self.contact_mm2,
            "amprep_mm3": self.routers,
            "straight_mm3": self.straight,
            "share_of_straight": shares,
            "prusaslicer_mm3": self.rivals,
        }


def generated_parts() -> dict[str, Mesh]:
    """Return the generated parts, standing on the plate at x = y = 0."""
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
    return {name: _standing(solid) for name, solid in solids.items()}


def meshes_of(files: Sequence[Path], host: Host) -> dict[str, Mesh]:
    """Return the meshes of all parts in mesh files, moved to stand on the plate.

    Raises
    ------
    InputError, MeshError
        When a file cannot be read, or a part is no solid.
    """

    def read(path: Path) -> list[Part]:
        reader = host.reader_for(path, {})
        return host.call(reader, path, params=host.params(reader, {}))

    parts = read_all(expand_inputs([(file, None) for file in files], host.suffixes), read)
    return {part.name: Mesh(part.mesh.vertices - part.mesh.bounds[0], part.mesh.triangles) for part in parts}


def _standing(solid: "Manifold") -> Mesh:
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
) -> VolumeResult:
    """Support a part that stands on the plate in every way; only squares with a free column below count."""
    size = mesh.bounds[1] - mesh.bounds[0]
    matrix = np.eye(4)
    matrix[:3, 3] = [*np.round((SPACE.size[:2] - size[:2]) / 2), 0.0] - mesh.bounds[0]
    part = PlacedPart(name, Part(name, mesh, mesh.signed_volume), matrix)
    volumes = {each: _volume(part, host, _router(host, each), cell, pitch, stop) for each in routers}
    straight, squares = _volume(part, host, straight_columns, cell, pitch, stop)
    return VolumeResult(
        name,
        squares * pitch * pitch,
        {each: volume for each, (volume, _) in volumes.items()},
        straight,
        {style: None if slicer is None else rival_volume(slicer, part.mesh, style) for style in STYLES},
    )


def straight_columns(problem: SupportProblem, stop: Stop, progress: Progress) -> SupportPlan:  # noqa: ARG001
    """Route every red square straight down; each must have white cubes all the way."""
    top = int(problem.red[:, 0].max(initial=0))
    flow = np.zeros((top + 1, *problem.voxels.shape[1:]), np.int32)
    for plane, y, x in problem.red.tolist():
        flow[1 : plane + 1, y, x] += 1
    plane, y, x = (each.astype(np.int32) for each in flow.nonzero())
    load = flow[plane, y, x]
    return SupportPlan(SupportEdges(plane, y, x, np.zeros(len(plane), np.uint8), load, load))


def free_below(cubes: Bytes, red: RedSquares) -> Bools:
    """Tell which red squares have white cubes all the way down."""
    blocked = np.cumsum(cubes != Voxel.FREE, axis=0)
    plane, y, x = red.square.T
    return np.asarray((plane > 0) & (blocked[np.maximum(plane, 1) - 1, y, x] == 0))


def _router(host: Host, name: str) -> Route:
    router = host.choose("router", name)
    params = host.params(router, {})

    def route(problem: SupportProblem, stop: Stop, progress: Progress) -> SupportPlan:
        rng = np.random.default_rng(0)
        return host.call(router, problem, params=params, rng=rng, stop=stop, progress=progress)

    return route


def _volume(
    part: PlacedPart, host: Host, route: Route, cell: str, pitch: float, stop: Stop
) -> tuple[float, int]:
    """Return the volume of the finished supports, and how many red squares they hold."""
    emitter = host.choose("cell", cell)
    params = host.params(emitter, {})
    material = host.material(emitter, pitch, pitch, params)
    layout = plan_supports(
        (part,),
        SPACE,
        PlanningRules(pitch_mm=pitch),
        material=material,
        route=route,
        choose=free_below,
        stop=stop,
        progress=silent,
    )
    bodies = build_supports(
        layout,
        (part,),
        lambda request: host.call(emitter, request, params=params, stop=stop, progress=silent),
        overlap=0.1,
        connector=ConnectorRules(),
        allow_surface=False,
        stop=stop,
        progress=silent,
    )
    return sum(abs(body.mesh.signed_volume) for body in bodies), int(layout.connected.sum())


STYLES = ("grid", "snug", "organic")
FILAMENT_MM = 1.75
_TIME_LIMIT_S = 300
_EXTRUSION = re.compile(r"G1 .*[XY].* E(\d*\.?\d+)")


def find_slicer() -> Path | None:
    """Return PrusaSlicer's executable on the search path, or None."""
    found = shutil.which("prusa-slicer") or shutil.which("PrusaSlicer")
    return None if found is None else Path(found)


def rival_volume(slicer: Path, mesh: Mesh, style: str) -> float | None:
    """Return the volume of the support that PrusaSlicer extrudes under the part, mm3; None if it refuses.

    Supports from the plate only, for faces under 45 degrees and bridges, otherwise PrusaSlicer's defaults: a
    sparse pattern of lines, with a gap below the part. It chooses the contact by its own rules.
    """
    with tempfile.TemporaryDirectory() as folder:
        model, code = Path(folder) / "part.stl", Path(folder) / "part.gcode"
        write_stl(mesh, model)
        options = {
            "support-material-threshold": "45",
            "support-material-style": style,
            "bed-shape": "0x0,250x0,250x210,0x210",
            "filament-diameter": str(FILAMENT_MM),
            "layer-gcode": "G92 E0",
            "output": str(code),
        }
        command = [str(slicer), "--export-gcode", "--support-material", "--support-material-auto"]
        command += [
            "--support-material-buildplate-only",
            "--dont-support-bridges=0",
            "--use-relative-e-distances",
        ]
        command += [word for name, value in options.items() for word in (f"--{name}", value)]
        command.append(str(model))
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_TIME_LIMIT_S)  # noqa: S603 - no shell
        if ended.returncode or not code.exists():
            return None
        return support_in(code.read_text(encoding="utf-8", errors="replace"))


def support_in(gcode: str) -> float:
    """Return the volume that G-code with relative extrusion lays down as support, mm3."""
    length, counts = 0.0, False
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            counts = line.startswith(";TYPE:Support material")
        elif counts and (found := _EXTRUSION.match(line)):
            length += float(found[1])
    return length * pi * FILAMENT_MM**2 / 4
