"""Clip finished supports to the territories of the parts that they hold."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.cells.instances import CellInstances
from amprep.geometry.supports.footprints import union_of
from amprep.geometry.supports.territory import columns_of
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

TOP = 1e5
"""Height (mm) above all supports."""

# Strategy. Cells and connectors stay in the columns of their voxels, and nearly all of these are inside the territory.
# So the columns in use tell without a look at the solid whether it may stick out. Only then, or where a cell is larger
# than its voxels, the solid is intersected with the extruded territory.


def territory_section(layout: SupportLayout, group: int) -> "CrossSection | None":
    """Return the region of the plate in which the supports of a group may be; None where parts share all space."""
    if not layout.territories:
        return None
    return union_of([layout.territories[part].section() for part in layout.group_parts[group]])


def clip_to_territory(
    layout: SupportLayout, group: int, solid: "Manifold", instances: CellInstances
) -> "Manifold":
    """Return the solid of a support group without what is outside the territories of its parts.

    Parameters
    ----------
    layout
        The layout, with the territories of the parts.
    group
        Number of the group.
    solid
        The solid, from the cells, connectors and feet of the group.
    instances
        The cells that it was made of.
    """
    from manifold3d import Manifold

    section = territory_section(layout, group)
    if section is None:
        return solid
    whole = columns_of(section, layout.grid).whole
    if not (_columns_in_use(layout, group) <= whole).all() or not _stay_in_voxels(instances, group):
        solid ^= section.extrude(TOP).translate((0.0, 0.0, -1.0))
    low, high = (np.array(corner) for corner in np.split(np.array(solid.bounding_box()), 2))
    for lo, hi in np.concatenate([layout.territories[part].boxes for part in layout.group_parts[group]]):
        if _meet((lo, hi), (low, high)):
            solid -= Manifold.cube((hi - lo).tolist()).translate(lo.tolist())
    return solid


def _columns_in_use(layout: SupportLayout, group: int) -> Bools:
    """Tell which columns of voxels ``(ny, nx)`` the cells and connectors of a group are in."""
    used = np.zeros(layout.grid.shape[1:], np.bool_)
    edges = layout.edges[layout.edges.group == group]
    red = layout.red.square[layout.red_group == group]
    for squares in (edges.upper, edges.lower, red):
        used[squares[:, 1], squares[:, 2]] = True
    return used


def _stay_in_voxels(instances: CellInstances, group: int) -> bool:
    """Tell whether the cells are inside the unit cube, so that their instances are inside their voxels."""
    extras = any(extra.group == group for extra in instances.cells.extra)
    inside = (((points >= -1e-6) & (points <= 1.0 + 1e-6)).all() for points, _ in instances.templates)
    return not extras and all(inside)


def _meet(one: tuple[Floats, Floats], other: tuple[Floats, Floats]) -> bool:
    """Tell whether two boxes overlap."""
    return bool((np.minimum(one[1], other[1]) - np.maximum(one[0], other[0]) > CONTACT_TOLERANCE).all())
