"""A lattice cell: a slender octagonal pillar in the middle of every prism."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from amprep.errors import JobError
from amprep.hookspecs import CellEmitter, hookimpl, require_bounds
from amprep.model import CellRequest, Cells, Mesh, Progress, Stop, Template

amprep_api = 1
SIDES = 8


@dataclass(frozen=True)
class PillarParams:
    """Parameters of the pillar.

    Attributes
    ----------
    diameter_mm
        Diameter of the circle around the octagon.
    """

    diameter_mm: float = 0.6

    def __post_init__(self) -> None:
        require_bounds(self, "diameter_mm", above=0)


@hookimpl
def amprep_cell_emitters() -> Iterator[CellEmitter]:
    """Yield the pillar."""
    yield CellEmitter(
        "pillar",
        "A slender octagonal pillar in the middle of every prism.",
        run=emit_pillars,
        params=PillarParams,
        material=pillar_material,
    )


def emit_pillars(request: CellRequest, *, params: PillarParams, stop: Stop, progress: Progress) -> Cells:
    """Place one pillar along every edge.

    Consecutive pillars have the same octagon where they meet, on oblique edges too: the matrices shear the unit cube
    sideways and leave its horizontal faces as they are.
    """
    pitch, count = request.grid.pitch, len(request.edges)
    if params.diameter_mm > pitch:
        raise JobError(
            f"pillar: diameter_mm must be at most the pitch of {pitch:.4g} mm, got {params.diameter_mm:g}"
        )
    return Cells(
        (pillar(params.diameter_mm / pitch),), np.zeros(count, np.int64), np.arange(count), request.matrices
    )


def pillar(diameter: float) -> Template:
    """Return the pillar in the unit cube; its bottom and top have the same triangles."""
    angles = (np.arange(SIDES) + 0.5) * 2 * np.pi / SIDES
    ring = 0.5 + diameter / 2 * np.column_stack([np.cos(angles), np.sin(angles)])
    vertices = np.vstack([np.column_stack([ring, np.full(SIDES, z)]) for z in (0.0, 1.0)])
    bottom = [(0, k + 1, k) for k in range(1, SIDES - 1)]
    top = [(SIDES, SIDES + k, SIDES + k + 1) for k in range(1, SIDES - 1)]
    sides = [(k, (k + 1) % SIDES, SIDES + (k + 1) % SIDES) for k in range(SIDES)]
    sides += [(k, SIDES + (k + 1) % SIDES, SIDES + k) for k in range(SIDES)]
    return Template("pillar", Mesh(vertices, np.array(bottom + top + sides)))


def pillar_material(pitch: float, step: float, params: PillarParams) -> tuple[float, float]:
    """Return the volume (mm3) of a vertical and of an oblique edge: octagon times step, as shearing keeps volume."""
    volume = 2 * np.sqrt(2) * (params.diameter_mm / 2) ** 2 * step
    return volume, volume
