"""What supports stand on at the plate: flanges or pads, kept away from parts, zones and one another."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.geometry.merging.union import finish
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.supports import footprints as bases
from amprep.model import CONTACT_TOLERANCE, BuildVolume, Mesh, PlacedPart
from amprep.model.contacts import Base

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

LEAST_GAP = 0.3
"""mm that bases keep from parts and from other supports at least."""


def make_bases(
    solids: Sequence[Mesh | None],
    parts: Sequence[PlacedPart],
    base: Base,
    space: BuildVolume | None,
    gap: float,
) -> list["Manifold | None"]:
    """Return the base of each support, None where it has none.

    A base lies on the plate, inside the build volume and out of its forbidden zones. It keeps `gap` mm, at least
    `LEAST_GAP`, from whatever part, its own included, and from the supports and bases made before it, sideways and
    upwards; what that cuts off from all feet is left out.

    Parameters
    ----------
    solids
        One per support group; None where it is no solid.
    """
    if base.kind == "direct":
        return [None] * len(solids)
    gap = max(gap, LEAST_GAP)
    height = base.height + gap
    stands = [None if mesh is None or not len(mesh.triangles) else _manifold(mesh) for mesh in solids]
    taken = [bases.shadow(_manifold(each.mesh), height) for each in parts if _is_low(each, height)]
    supports = [None if each is None else bases.shadow(each, height) for each in stands]
    zones = _zones(space, base.height)
    found: list[Manifold | None] = []
    for group, support in enumerate(stands):
        if support is None:
            found.append(None)
            continue
        others = [each for number, each in enumerate(supports) if number != group and each is not None]
        closed = bases.sum_of([bases.grown(bases.sum_of(taken + others), gap), *zones])
        plan = _plan(bases.feet_of(support), closed, base, space)
        taken.append(plan)
        found.append(None if plan.is_empty() else plan.extrude(base.height))
    return found


def _plan(
    feet: "CrossSection", closed: "CrossSection", base: Base, space: BuildVolume | None
) -> "CrossSection":
    """Return the shape of one support's base in plan."""
    pad = bases.raft(feet, base.margin) if base.kind == "raft" else bases.grown(feet, base.margin)
    if space is not None:
        pad ^= bases.plate(space.size, disc=space.shape == "cylinder")
    pad = bases.standing(pad - closed, feet)
    return bases.perforated(pad, feet, base.hole) if base.kind == "raft" and base.hole else pad


def _zones(space: BuildVolume | None, height: float) -> list["CrossSection"]:
    """Return the forbidden zones that reach below a height."""
    if space is None:
        return []
    low = space.zone_lo[:, 2] < height
    more = np.full(3, CONTACT_TOLERANCE)
    return [
        bases.box(lo - more, hi + more) for lo, hi in zip(space.zone_lo[low], space.zone_hi[low], strict=True)
    ]


def _is_low(placed: PlacedPart, height: float) -> bool:
    return bool(placed.part.is_solid and placed.mesh.bounds[0][2] < height)


def _manifold(mesh: Mesh) -> "Manifold":
    return as_manifold(*mesh.arrays)


def with_base(mesh: Mesh | None, base: "Manifold | None") -> Mesh | None:
    """Return a support united with its base."""
    if base is None:
        return mesh
    solids = [base] if mesh is None or not len(mesh.triangles) else [_manifold(mesh), base]
    return Mesh(*finish(solids))
