"""Make flanges and rafts below supports, clear of parts, forbidden zones and other supports."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.supports import footprints
from amprep.model import CONTACT_TOLERANCE, BuildVolume, PlacedPart, SupportBody
from amprep.model.contacts import BaseRules
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

LEAST_GAP = 0.3
"""Least distance (mm) of bases from parts and from other supports."""


def make_bases(
    supports: Sequence["Manifold | None"],
    parts: Sequence[PlacedPart],
    rules: BaseRules,
    space: BuildVolume | None,
    gap: float,
    beside: "CrossSection | None" = None,
    regions: Sequence["CrossSection | None"] = (),
) -> list["Manifold | None"]:
    """Return the base of each support, None where it has none.

    A base is inside the build volume and outside its forbidden zones. It keeps a distance of `gap`, at least
    `LEAST_GAP`, horizontally and vertically, from all parts, from other supports, and from the bases made before it.
    Pieces of a base below which no foot stands are dropped.

    Parameters
    ----------
    supports
        Solid of each support group, None for a group without.
    parts
        Placed parts of the build.
    rules
        Shape of the bases.
    space
        Build volume, if it limits the bases.
    gap
        XY distance (mm) between supports and parts.
    beside
        Plan of the supports of other passes of planning.
    regions
        Territory of each support group, which limits its base; None where it has none.
    """
    if rules.base == "direct":
        return [None] * len(supports)
    gap = max(gap, LEAST_GAP)
    height = rules.base_height_mm + gap
    taken = [
        footprints.shadow(as_manifold(*each.mesh.arrays), height) for each in parts if _is_low(each, height)
    ]
    shadows = [None if each is None else footprints.shadow(each, height) for each in supports]
    taken += [] if beside is None else [beside]
    zones = _zones(space, rules.base_height_mm)
    found: list[Manifold | None] = []
    for group, (support, region) in enumerate(zip(supports, regions or [None] * len(supports), strict=True)):
        if support is None:
            found.append(None)
            continue
        others = [each for number, each in enumerate(shadows) if number != group and each is not None]
        obstacles = footprints.grown(footprints.union_of(taken + others), gap)
        closed = footprints.union_of([obstacles, *zones])
        plan = _plan(footprints.feet_of(support), closed, rules, space, region)
        taken.append(plan)
        found.append(None if plan.is_empty() else plan.extrude(rules.base_height_mm))
    return found


def plan_of_others(
    earlier: Sequence[SupportBody], later: Sequence[SupportLayout], rules: BaseRules
) -> "CrossSection | None":
    """Return the plan of the supports of other passes near the plate; None where there are no bases or no others.

    Parameters
    ----------
    earlier
        Finished supports.
    later
        Layouts of supports that are not finished.
    rules
        Shape of the bases.
    """
    if rules.base == "direct" or not (earlier or later):
        return None
    height = rules.base_height_mm + LEAST_GAP
    plans = [
        footprints.shadow(as_manifold(*each.mesh.arrays), height) for each in earlier if not each.surface
    ]
    for layout in later:
        low = layout.edges[layout.edges.plane * layout.grid.step <= height + layout.grid.step].voxels
        lo = layout.grid.origin + np.unique(low[:, ::-1], axis=0) * layout.grid.size
        plans += [footprints.box(corner, corner + layout.grid.size) for corner in lo]
    return footprints.union_of(plans)


def _plan(
    feet: "CrossSection",
    closed: "CrossSection",
    rules: BaseRules,
    space: BuildVolume | None,
    region: "CrossSection | None",
) -> "CrossSection":
    """Return the shape of one base in plan."""
    make = footprints.raft if rules.base == "raft" else footprints.grown
    plan = make(feet, rules.base_margin_mm)
    if space is not None:
        plan ^= footprints.plate(space.size, disc=space.shape == "cylinder")
    if region is not None:
        plan ^= region
    plan = footprints.below_feet(plan - closed, feet)
    has_holes = rules.base == "raft" and rules.raft_hole_mm
    return footprints.perforated(plan, feet, rules.raft_hole_mm) if has_holes else plan


def _zones(space: BuildVolume | None, height: float) -> list["CrossSection"]:
    """Return the forbidden zones that begin below a height."""
    if space is None:
        return []
    low = space.zone_lo[:, 2] < height
    margin = np.full(3, CONTACT_TOLERANCE)
    return [
        footprints.box(lo - margin, hi + margin)
        for lo, hi in zip(space.zone_lo[low], space.zone_hi[low], strict=True)
    ]


def _is_low(placed: PlacedPart, height: float) -> bool:
    return bool(placed.part.is_solid and placed.mesh.bounds[0][2] < height)
