"""Tell whether the walls of a lattice cell are thinner than the least wall, and find a pitch at which they are not."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from amprep.cells.answers import Emit
from amprep.cells.samples import LAYERS, column_for
from amprep.errors import JobError
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model import Cells
from amprep.model.supports.rules import SectionRules, SupportRules

if TYPE_CHECKING:
    from manifold3d import CrossSection

_KEPT = 0.6
"""Fraction of a section that discs of the least wall cover if its walls are thick enough: two thirds of the
quarter of a disc."""

_TOLERANCE = 0.03
"""Length (mm) by which walls may be thinner, because circles are polygons and walls have bends."""


_PLACES = (0.02, 0.5)
"""Heights of sections in a layer, as fractions of it: cells are narrow at planes or at half the height."""


_MOST_STEPS = 20
"""Steps of 0.1 mm by which a larger pitch is looked for."""


def suitable_pitch(emit: Emit, pitch: float, rules: SupportRules) -> float:
    """Return a pitch (mm), or the next larger one in tenths in which the cell can be made with walls thick enough.

    Parameters
    ----------
    emit
        Calls the cell.
    pitch
        The pitch that suits parts and memory, mm; it is returned if no pitch suits the cell.
    rules
        The least wall, the leg ratio and the strut angle.
    """
    return next((each for each in _pitches_from(pitch) if _is_thin(emit, each, rules) is False), pitch)


def wall_advice(name: str, emit: Emit, pitch: float, rules: SupportRules) -> Iterator[str]:
    """Yield a sentence if the walls of the cell called `name` are thinner than the least wall at a pitch (mm)."""
    if not _is_thin(emit, pitch, rules):
        return
    larger = next((each for each in _pitches_from(pitch) if _is_thin(emit, each, rules) is False), None)
    remedy = "thicker walls" if larger is None else f"a larger pitch: --set supports.pitch_mm={larger:g}"
    yield (
        f"at a pitch of {pitch:g} mm walls of the cell {name} are thinner than the least wall of "
        f"{rules.least_wall_mm:g} mm and are left out; choose {remedy}"
    )


def _pitches_from(pitch: float) -> Iterator[float]:
    """Yield a pitch (mm), and larger ones in tenths."""
    yield pitch
    tenths = math.floor(10.0 * pitch + 1e-9)
    yield from ((tenths + number) / 10.0 for number in range(1, _MOST_STEPS))


def _is_thin(emit: Emit, pitch: float, rules: SupportRules) -> bool | None:
    """Tell whether the walls of the cell are too thin at a pitch; None if the cell refuses the pitch."""
    if rules.least_wall_mm <= 0.0:
        return False
    try:
        return has_thin_walls(emit, pitch, pitch * math.tan(math.radians(rules.strut_angle_deg)), rules)
    except JobError:
        return None


def has_thin_walls(emit: Emit, pitch: float, step: float, rules: SectionRules) -> bool:
    """Tell whether most of some section of a lone column is thinner than the least wall, so that it parts there.

    Walls without thickness, and cells that answer with finished meshes alone, are not judged.

    Parameters
    ----------
    emit
        Calls the cell.
    pitch, step
        Width and height (mm) of a voxel.
    rules
        The least wall, and the leg ratio, by which cells choose default sizes.
    """
    request = column_for(pitch, step, rules)
    cells = emit(request)
    low = float(request.edges.plane.min() - 1) * step
    heights = [low + (layer + place) * step for layer in range(1, LAYERS) for place in _PLACES]
    found = [each for each in (_section(cells, height) for height in heights) if each.area() > 0.0]
    radius = (rules.least_wall_mm - _TOLERANCE) / 2.0
    kept = (each.offset(-radius).offset(radius).area() / each.area() for each in found)
    return radius > 0.0 and any(fraction < _KEPT for fraction in kept)


def _section(cells: Cells, height: float) -> "CrossSection":
    """Return the horizontal section of all cells at a height, mm."""
    from manifold3d import CrossSection, OpType

    found = []
    for template, matrix in zip(cells.template, cells.matrix, strict=True):
        mesh = cells.templates[template].mesh
        solid = as_manifold(mesh.vertices @ matrix[:, :3].T + matrix[:, 3], mesh.triangles)
        if accepted(solid):
            found.append(solid.slice(height))
    return CrossSection.batch_boolean(found, OpType.Add) if found else CrossSection()
