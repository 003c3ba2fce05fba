"""Divide legs that only the finished solids show, by struts or further columns."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.model.supports.edges import SupportEdges
from amprep.supports.layout import SupportLayout
from amprep.supports.legs.divide import Division
from amprep.supports.legs.find import RoutedLeg
from amprep.supports.legs.room import OpenVoxels, Room
from amprep.supports.legs.sections import DIRECTION_COUNT, Sections, find_sections
from amprep.supports.legs.shorten import longest_strut

_BESIDE = 0.25
"""Distance (in pitches) from the pieces of a leg up to which squares belong to it."""

_SHORTER = 0.75
"""Fraction of the leg ratio to which legs are divided: the solid showed that planning takes them for too short."""

# Strategy. Planning knows a leg by the squares of the grid. Where a wall, a hole or the border of a territory cuts what
# it took for a strut or for a wider section, the solid has a leg that planning does not see. Its pieces lead back to
# squares, one section in each plane, and these are divided like any other leg, as wide as the solid is.


class FinishedLeg(NamedTuple):
    """A leg of a finished solid that is too long for its width.

    Attributes
    ----------
    group
        Its support group.
    boxes
        ``(k, 2, 3)`` mm, boxes around its pieces, one for each slab.
    """

    group: int
    boxes: Floats

    @property
    def middle(self) -> Floats:
        """The box ``(2, 3)`` mm around the piece in its middle."""
        return np.asarray(self.boxes[len(self.boxes) // 2])

    @property
    def width(self) -> float:
        """Width (mm) of its narrower side, where that is greatest."""
        return float((self.boxes[:, 1, :2] - self.boxes[:, 0, :2]).min(axis=1).max())


def divide_finished(layout: SupportLayout, legs: Sequence[FinishedLeg], ratio: float) -> SupportLayout:
    """Return a layout with struts or further columns at legs of finished solids; the same one if there is no room.

    Parameters
    ----------
    layout
        The layout of the solids.
    legs
        Legs that are too long.
    ratio
        Largest ratio of length to width.
    """
    grid, edges = layout.grid, layout.edges
    held = np.concatenate([layout.red.square[layout.connected], layout.feet[:, :3]])
    sections = find_sections(grid, edges, held, np.full(DIRECTION_COUNT, grid.pitch))
    opened = [OpenVoxels(layout.voxels, each.first, each.opened) for each in layout.territories]
    room = Room(sections, edges, opened.__getitem__ if opened else lambda _: OpenVoxels(layout.voxels))
    routed = [each for each in (_routed(leg, layout, sections) for leg in legs) if each is not None]
    ratio *= _SHORTER
    longest = longest_strut(grid, ratio * min((leg.width for leg in legs), default=grid.pitch))
    division = Division(room, routed, ratio, longest)
    for number in range(len(routed)):
        division.divide(number)
    if not room.rows:
        return layout
    added = SupportEdges.from_rows(room.rows)
    group_of_part = {part: group for group, parts in enumerate(layout.group_parts) for part in parts}
    groups = np.array([group_of_part[part] for part in added.part.tolist()], np.int32)
    merged = SupportEdges.concatenate([edges, replace(added, group=groups)]).merged()
    return replace(layout, edges=merged)


def _routed(leg: FinishedLeg, layout: SupportLayout, sections: Sections) -> RoutedLeg | None:
    """Return a leg as a chain of sections, one in each plane; None if it has none between its ends."""
    inside = _are_in(leg, layout, sections)
    planes, first = np.unique(sections.square[inside, 0], return_index=True)
    if len(planes) < 3 or planes[-1] - planes[0] != len(planes) - 1:
        return None
    chain = sections.section[inside][first].tolist()
    lengths = (layout.grid.step,) * (len(chain) - 1)
    return RoutedLeg(tuple(chain), lengths, (leg.width,) * len(chain), 0.0, (False, False))


def _are_in(leg: FinishedLeg, layout: SupportLayout, sections: Sections) -> Bools:
    """Tell which squares ``(n,)`` of the group of a leg are in the box around its piece at their height.

    Squares at the ends, between two slabs, belong to the slab that is nearer.
    """
    grid, square = layout.grid, sections.square
    beside = _BESIDE * grid.pitch
    height = grid.origin[2] + square[:, 0] * grid.step
    boxes = leg.boxes[np.argsort(leg.boxes[:, 0, 2])]
    slab = np.rint((height - boxes[:, :, 2].mean(axis=1)[0]) / grid.step).astype(np.int64)
    own = boxes[np.clip(slab, 0, len(boxes) - 1), :, :2]
    axis = grid.origin[:2] + (square[:, :0:-1] + 0.5) * grid.pitch
    inside = ((axis >= own[:, 0] - beside) & (axis <= own[:, 1] + beside)).all(axis=1)
    of_group = np.isin(sections.part, layout.group_parts[leg.group])
    return np.asarray(inside & of_group & (slab >= 0) & (slab < len(boxes)))
