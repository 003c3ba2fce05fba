"""Cut drain holes into finished supports that would trap powder, for cells that promise to release it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.powder.drain_holes import find_drain_holes
from amprep.model import Mesh
from amprep.supports.solids.keep_out import drop_floating

if TYPE_CHECKING:
    from manifold3d import Manifold

_ROUNDS = 4
"""Largest number of rounds; a drain hole may end in another pocket, which the next round opens."""

_CRUMB = 1e-3
"""Largest volume (mm3) of support that may lose its connection to the plate by a drain hole."""


_TRIES = 4
"""Largest number of times that holes are left out because a piece would float."""

_Hole = tuple[Floats, Floats]
"""Least and greatest corner of a hole, mm."""


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
    around = [(part.vertices, part.triangles) for part in parts]
    grounded = Mesh(*drop_floating(*arrays_of(solid), boxes))
    done: list[_Hole] = []
    refused: set[bytes] = set()
    for _ in range(_ROUNDS):
        found = find_drain_holes(grounded.arrays, around, diameter) if len(grounded.triangles) else []
        holes = [hole for hole in found if _key(hole) not in refused]
        tried = _cut(solid, grounded, holes, boxes)
        kept = set() if tried is None else {_key(hole) for hole in tried.holes}
        refused.update({_key(hole) for hole in holes} - kept)
        if tried is None:
            break
        solid, grounded = tried.solid, tried.grounded
        done += tried.holes
    low, high = np.array(done).reshape(-1, 2, 3).swapaxes(0, 1)
    return solid, (low, high)


class _Opened(NamedTuple):
    """A support with holes, what of it stands, and the holes."""

    solid: "Manifold"
    grounded: Mesh
    holes: list[_Hole]


def _cut(
    solid: "Manifold", grounded: Mesh, holes: list[_Hole], boxes: tuple[Floats, Floats]
) -> _Opened | None:
    """Cut holes into a support, apart from those by which something would lose its connection to the plate.

    As much must stand as stood before, apart from the holes, and from pieces that stood by touching others along an
    edge. None if no hole is left.
    """
    from manifold3d import Manifold, OpType

    for _ in range(_TRIES):
        if not holes:
            break
        cuts = [Manifold.cube((hi - lo).tolist()).translate(lo.tolist()) for lo, hi in holes]
        opened = evaluated(solid - Manifold.batch_boolean(cuts, OpType.Add))
        rest = Mesh(*drop_floating(*arrays_of(opened), boxes))
        if rest.signed_volume - grounded.signed_volume >= opened.volume() - solid.volume() - _CRUMB:
            return _Opened(opened, rest, holes)
        cut = as_manifold(*grounded.arrays) - Manifold.batch_boolean(cuts, OpType.Add)
        harmless = _apart_from_floating(holes, cut, boxes)
        if len(harmless) == len(
            holes
        ):  # what is lost touched the rest along an edge alone, and touches no hole
            return _Opened(opened, rest, holes)
        holes = harmless
    return None


def _apart_from_floating(holes: list[_Hole], cut: "Manifold", boxes: tuple[Floats, Floats]) -> list[_Hole]:
    """Return the holes that touch no piece that floats in what stood and was cut."""
    floating = [
        np.array(piece.bounding_box()).reshape(2, 3)
        for piece in cut.decompose()
        if not len(drop_floating(*arrays_of(piece), boxes)[1])
    ]
    low, high = np.array(floating).reshape(-1, 2, 3).swapaxes(0, 1)
    return [
        (lo, hi)
        for lo, hi in holes
        if not ((low <= hi + CONTACT_TOLERANCE) & (high >= lo - CONTACT_TOLERANCE)).all(axis=1).any()
    ]


def _key(hole: _Hole) -> bytes:
    return np.concatenate(hole).tobytes()
