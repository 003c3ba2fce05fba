"""Cut drain holes into finished supports that would trap powder, for cells that promise to release it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.powder.drain_holes import find_drain_holes
from amprep.model import Mesh
from amprep.supports.solids.keep_out import drop_floating

if TYPE_CHECKING:
    from manifold3d import Manifold

_ROUNDS = 4
"""Largest number of rounds; a drain hole may end in another pocket, which the next round opens."""

_BESIDE = 0.01
"""Distance (mm) of a piece from a hole that cut it off."""

_SLICES = 3
"""Slices into which holes are divided to look for what is left beside them."""

_CRUMB = 1e-3
"""Largest volume (mm3) of support that may lose its connection to the plate by a drain hole."""


def cut_drain_holes(
    solid: "Manifold",
    parts: Sequence[Mesh],
    diameter: float,
    boxes: tuple[Floats, Floats],
    least_wall: float = 0.0,
) -> "Manifold":
    """Return a support with drain holes for a ball, wherever short straight holes exist.

    Parameters
    ----------
    solid
        The support; pieces of it that float stay.
    parts
        Parts that the support holds.
    diameter
        Diameter (mm) of the ball that must be able to escape.
    boxes
        Least and greatest corners ``(k, 3)`` of the boxes in which feet on parts end.
    least_wall
        Least thickness of supports, mm; what is left thinner beside a hole is cut away with it.
    """
    from manifold3d import Manifold, OpType

    around = [(part.vertices, part.triangles) for part in parts]
    grounded = Mesh(*drop_floating(*arrays_of(solid), boxes))
    for _ in range(_ROUNDS):
        holes = find_drain_holes(grounded.arrays, around, diameter) if len(grounded.triangles) else []
        if not holes:
            break
        cuts = [Manifold.cube((hi - lo).tolist()).translate(lo.tolist()) for lo, hi in holes]
        opened = evaluated(solid - Manifold.batch_boolean(cuts, OpType.Add))
        if least_wall > 0.0 and (rests := _thin_rests(opened, holes, least_wall)):
            opened = evaluated(opened - Manifold.batch_boolean(rests, OpType.Add))
        rest = Mesh(*drop_floating(*arrays_of(opened), boxes))
        # as much must stand as stood before, apart from the holes
        if rest.signed_volume - grounded.signed_volume < opened.volume() - solid.volume() - _CRUMB:
            break
        solid, grounded = opened, rest
    return solid


def _thin_rests(
    opened: "Manifold", holes: Sequence[tuple[Floats, Floats]], least_wall: float
) -> list["Manifold"]:
    """Return solids around the pieces that holes leave beside them and in which no disc of the least wall fits.

    Pieces are looked for in horizontal sections, of which each slice of a hole has one: beside tips, which taper, what
    is left at the lower end of a hole can be thick enough, and thin above.
    """
    low, high = (np.array([each[end] for each in holes]) for end in (0, 1))
    levels = np.linspace(low[:, 2], high[:, 2], _SLICES + 1)
    found = []
    for bottom, top in zip(levels, levels[1:], strict=False):
        for height in heights_through(bottom, top):
            cut = (bottom < height) & (top > height)
            for piece in opened.slice(height).decompose():
                left, front, right, back = piece.bounds()
                beside = cut & (low[:, :2] <= (right + _BESIDE, back + _BESIDE)).all(axis=1)
                beside &= (high[:, :2] >= (left - _BESIDE, front - _BESIDE)).all(axis=1)
                if beside.any() and piece.offset(_BESIDE - least_wall / 2.0).is_empty():
                    ends = float(bottom[beside].min()), float(top[beside].max())
                    prism = piece.offset(_BESIDE).extrude(ends[1] - ends[0])
                    found.append(prism.translate((0.0, 0.0, ends[0])))
    return found


def heights_through(low: Floats, high: Floats) -> list[float]:
    """Return few heights such that one is inside each interval from `low` to `high` ``(k,)`` mm."""
    heights: list[float] = []
    inner = 0.2 * (high - low)
    for number in np.argsort(high - inner, kind="stable").tolist():
        if not heights or heights[-1] < low[number] + inner[number]:
            heights.append(float(high[number] - inner[number]))
    return heights
