"""Make the crossing walls of the hatch as a template in the unit cube, with perforations, teeth and gaps."""

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.geometry.cells.ports import conform
from amprep.model import Mesh, Template

if TYPE_CHECKING:
    from manifold3d import Manifold

_OVER = 0.5
"""Distance, in edges of the cube, by which cutting bodies extend beyond the cube."""


class HatchWalls(NamedTuple):
    """Walls of a cell. Lengths are fractions of the pitch, heights are fractions of the step.

    Attributes
    ----------
    number
        Number of walls in each of the two directions.
    thickness
        Thickness of a wall.
    perforation
        Width and height of the openings between two crossings; 0 for none.
    teeth
        Number of teeth along the top of each wall; 0 for none.
    tooth, root
        Width of a tooth at the top, and depth of the notches; a depth of 1 cuts the whole wall.
    gap
        Distance of the walls to the sides x = 0 and y = 0.
    """

    number: int
    thickness: float
    perforation: tuple[float, float] = (0.0, 0.0)
    teeth: int = 0
    tooth: float = 0.0
    root: float = 0.0
    gap: tuple[float, float] = (0.0, 0.0)


@lru_cache(64)
def hatch_template(walls: HatchWalls) -> Template:
    """Return the walls as one closed mesh. Opposite sides without a gap have the same triangles."""
    from manifold3d import Manifold, OpType

    along_x = [_plate(walls, (k + 0.5) / walls.number) for k in range(walls.number)]
    along_y = [_transposed(plate) for plate in along_x]
    low_x, low_y = walls.gap
    solids = [plate ^ _box(low_x, 0.0) for plate in along_x] + [plate ^ _box(0.0, low_y) for plate in along_y]
    mesh = Manifold.batch_boolean(solids, OpType.Add).to_mesh64()
    points, triangles = conform(
        np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)
    )
    return Template(f"hatch {walls.number}", Mesh(points, triangles))


def _plate(walls: HatchWalls, y: float) -> "Manifold":
    """Return one wall along x with its openings and notches."""
    from manifold3d import Manifold, OpType

    half = walls.thickness / 2.0
    plate = Manifold.cube([1.0, walls.thickness, 1.0]).translate([0.0, y - half, 0.0])
    cuts = [_prism(outline, y) for outline in [*_perforations(walls), *_notches(walls)]]
    return plate - Manifold.batch_boolean(cuts, OpType.Add) if cuts else plate


def _perforations(walls: HatchWalls) -> list[list[tuple[float, float]]]:
    """Return the outlines of diamonds at half the height, one between any two neighbouring crossings."""
    width, height = walls.perforation
    if width <= 0.0:
        return []
    spans = [k / walls.number for k in range(walls.number + 1)]
    a, b = width / 2.0, height / 2.0
    return [[(x - a, 0.5), (x, 0.5 - b), (x + a, 0.5), (x, 0.5 + b)] for x in spans]


def _notches(walls: HatchWalls) -> list[list[tuple[float, float]]]:
    """Return the outlines of the notches between teeth: wedges from the top, or slots through the whole wall."""
    if not walls.teeth:
        return []
    half = (1.0 / walls.teeth - walls.tooth) / 2.0
    middles = [k / walls.teeth for k in range(walls.teeth + 1)]
    if walls.root >= 1.0:
        return [
            [(x - half, -_OVER), (x + half, -_OVER), (x + half, 1 + _OVER), (x - half, 1 + _OVER)]
            for x in middles
        ]
    wide = half * (1.0 + _OVER / walls.root)  # the sides of the wedge continue above the cube
    return [[(x, 1.0 - walls.root), (x + wide, 1.0 + _OVER), (x - wide, 1.0 + _OVER)] for x in middles]


def _prism(outline: list[tuple[float, float]], y: float) -> "Manifold":
    """Return a body with this outline in x and z that crosses a wall at y."""
    from manifold3d import Manifold

    plan = np.array(outline)
    ends = [
        np.column_stack([plan[:, 0], np.full(len(plan), y + side), plan[:, 1]]) for side in (-_OVER, _OVER)
    ]
    return Manifold.hull_points(np.vstack(ends))


def _transposed(solid: "Manifold") -> "Manifold":
    """Return the solid with x and y exchanged."""
    return solid.mirror([1.0, -1.0, 0.0])


def _box(low_x: float, low_y: float) -> "Manifold":
    """Return the unit cube without the gaps at x = 0 and y = 0."""
    from manifold3d import Manifold

    return Manifold.cube([1.0 - low_x, 1.0 - low_y, 1.0]).translate([low_x, low_y, 0.0])
