"""Estimate how much room beside a part its supports need."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.supports import Voxel
from amprep.overhangs.known import moved_in_plan
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.grid.red_squares import SupportGrid, make_grid
from amprep.supports.grid.sizing import usual_pitch
from amprep.supports.grid.territory import find_territories, margin_of
from amprep.supports.rules import PlanningRules

MOST_VOXELS = 300_000
"""Largest number of voxels of the grid of a part; a coarser pitch is used for larger parts."""

MOST_ROOM = 15.0
"""Largest margin (mm) that is tried."""


# Strategy. More margin never closes a voxel for a part that is alone, so that the number of red squares with a path
# grows with the margin, and the least margin with the greatest number is found by bisection. Most parts need no more
# than they have: their red squares are above free columns, or as many have a path as with the greatest margin.
def needed_margin(placed: PlacedPart, overhangs: PartOverhangs, rules: PlanningRules) -> float:
    """Return the least margin (mm) of the territory of a part with which as many of its supports as possible stand.

    The part is alone on a coarse grid, at its height and in its orientation. The margin is at least its own, and at
    most the largest drift.

    Parameters
    ----------
    placed
        The part in a build.
    overhangs
        Its overhangs.
    rules
        Rules for the grid, the territory and the drift.
    """
    own = margin_of(placed, rules)
    most = max(min(rules.drift_mm or MOST_ROOM, MOST_ROOM), own)
    if most <= own or not _has_overhangs(overhangs):
        return own
    shift = np.array([*(2.0 * most - placed.mesh.bounds[0][:2]), 0.0])
    alone, moved = _moved(placed, shift), moved_in_plan(overhangs, shift)
    laid = _coarse_grid(alone, moved, rules, most)
    if _all_above_free_columns(laid):
        return own

    def reached(margin: float) -> int:
        part = replace(alone.part, overrides=replace(alone.part.overrides, territory_margin_mm=margin))
        (territory,) = find_territories([replace(alone, part=part)], laid, rules)
        return int(territory.reachable.sum())

    goal = reached(most)
    steps = int(np.ceil((most - own) / laid.grid.pitch))
    low, high = -1, steps  # more than `low` steps are needed, `high` are enough
    while high - low > 1:
        middle = 0 if low < 0 else (low + high) // 2
        low, high = (low, middle) if reached(own + middle * laid.grid.pitch) == goal else (middle, high)
    return min(own + high * laid.grid.pitch, most)


def _has_overhangs(found: PartOverhangs) -> bool:
    return any(len(each) for each in (found.overhangs.faces, found.overhangs.edges, found.overhangs.tips))


def _moved(placed: PlacedPart, shift: Floats) -> PlacedPart:
    """Return the part after a translation, which leaves room between it and the walls x = 0 and y = 0."""
    matrix = placed.matrix.copy()
    matrix[:3, 3] += shift
    return replace(placed, matrix=matrix)


def _coarse_grid(
    placed: PlacedPart, overhangs: PartOverhangs, rules: PlanningRules, margin: float
) -> SupportGrid:
    _, high = placed.mesh.bounds
    space = BuildVolume(np.array([*(high[:2] + 2.0 * margin), high[2] + 10.0]))
    slope = float(np.tan(np.radians(rules.strut_angle_deg)))
    volume = float(np.prod(high - [margin, margin, 0.0]))
    pitch = max(usual_pitch([placed]), (volume / slope / MOST_VOXELS) ** (1 / 3))
    coarse = replace(rules, pitch_mm=pitch, memory_mb=max(rules.memory_mb, 100))
    return make_grid([placed], [overhangs], space, coarse)


def _all_above_free_columns(laid: SupportGrid) -> bool:
    """Tell whether all red squares are above columns of free voxels."""
    clear = np.logical_and.accumulate(laid.voxels == Voxel.FREE, axis=0)
    plane, y, x = laid.red.square[laid.red.square[:, 0] > 0].T
    return bool(clear[plane - 1, y, x].all())
