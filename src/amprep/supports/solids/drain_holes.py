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

_CRUMB = 1e-3
"""Largest volume (mm3) of support that may lose its connection to the plate by a drain hole."""


def cut_drain_holes(
    solid: "Manifold",
    parts: Sequence[Mesh],
    diameter: float,
    boxes: tuple[Floats, Floats],
) -> tuple["Manifold", tuple[Floats, Floats]]:
    """Cut drain holes for a ball into a support, wherever short straight holes exist.

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

    Returns
    -------
    solid, holes
        The support, and the least and greatest corners ``(n, 3)`` mm of the holes.
    """
    from manifold3d import Manifold, OpType

    around = [(part.vertices, part.triangles) for part in parts]
    grounded = Mesh(*drop_floating(*arrays_of(solid), boxes))
    done: list[tuple[Floats, Floats]] = []
    for _ in range(_ROUNDS):
        holes = find_drain_holes(grounded.arrays, around, diameter) if len(grounded.triangles) else []
        if not holes:
            break
        cuts = [Manifold.cube((hi - lo).tolist()).translate(lo.tolist()) for lo, hi in holes]
        opened = evaluated(solid - Manifold.batch_boolean(cuts, OpType.Add))
        rest = Mesh(*drop_floating(*arrays_of(opened), boxes))
        # as much must stand as stood before, apart from the holes
        if rest.signed_volume - grounded.signed_volume < opened.volume() - solid.volume() - _CRUMB:
            break
        solid, grounded = opened, rest
        done += holes
    low, high = np.array(done).reshape(-1, 2, 3).swapaxes(0, 1)
    return solid, (low, high)
