"""Cuts ways out of finished supports where they would lock powder in, for cells that promise to let it out."""

from collections.abc import Sequence

from amprep.arrays import Floats
from amprep.geometry.merging.union import arrays_of, evaluated, finish
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.powder.drain_holes import find_drains
from amprep.model import Mesh
from amprep.supports.solids.keep_out import drop_floating

_ROUNDS = 4
"""A way may end in another pocket's way."""

_CRUMB = 1e-3
"""mm3; more than that must not come to hang in the air because of a way out."""


def cut_drain_holes(solid: Mesh, parts: Sequence[Mesh], hole: float, boxes: tuple[Floats, Floats]) -> Mesh:
    """Return a support with ways out for a ball of diameter `hole` mm, wherever short straight ones exist.

    Parameters
    ----------
    parts
        Those that the support holds.
    boxes
        Least and greatest corners of the boxes in which feet on parts end.
    """
    from manifold3d import Manifold, OpType

    around = [(part.vertices, part.triangles) for part in parts]
    whole = as_manifold(solid.vertices, solid.triangles)
    arrays, found = (solid.vertices, solid.triangles), False
    for _ in range(_ROUNDS):
        drains = find_drains(arrays, around, hole)
        if not drains:
            break
        cuts = [Manifold.cube((hi - lo).tolist()).translate(lo.tolist()) for lo, hi in drains]
        opened = evaluated(whole - Manifold.batch_boolean(cuts, OpType.Add))
        stands = Mesh(*drop_floating(*arrays_of(opened), boxes))
        if stands.signed_volume < opened.volume() - _CRUMB:
            break
        whole, arrays, found = opened, (stands.vertices, stands.triangles), True
    return Mesh(*finish([as_manifold(*arrays)])) if found else solid
