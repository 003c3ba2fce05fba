"""Judge whether neighbouring cells match on their common sides."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.checks.violation import Violation
from amprep.geometry.cells.ports import PLANE_AXES, SNAP, flush_sides, snapped
from amprep.model.cells import CellRequest, Cells, Template

if TYPE_CHECKING:
    from manifold3d import CrossSection

PORTS = "ports match"
SIDE_NAMES = ("left", "right", "front", "back", "bottom", "top")

LARGEST_DIFFERENCE = 0.05
"""Fraction of the larger port by which two ports may differ: flat struts extend beyond the ball at the port."""

SMALLEST_CONTACT = 0.25
"""Fraction of the smaller port that must be in contact where the direction or the cell changes."""


def check_ports(request: CellRequest, cells: Cells) -> list[Violation]:
    """Judge every pair of neighbouring templates in the answer once.

    Neighbours side by side of the same direction must have equal sections with the common side, unless one of them does
    not reach it. Of two cells above each other, the upper one must stand on the lower one; if both have the same
    template, the sections must be equal, too.
    """
    ports = _Ports(cells.templates)
    found = [
        violation
        for axis, low, high, same in sorted(_neighbours(request, cells))
        for violation in ports.judge(axis, low, high, same)
    ]
    return list(dict.fromkeys(found))


def port_areas(template: Template) -> Floats:
    """Return the fraction of each side that the template covers, ``(6,)`` in the order of `SIDE_NAMES`."""
    ports = _Ports((template,))
    return np.array([float(ports.section(0, side).area()) for side in range(6)])


def _neighbours(request: CellRequest, cells: Cells) -> set[tuple[int, int, int, bool]]:
    """List pairs of adjacent templates: axis, template on its low side, on its high side, whether both are to match."""
    edges = request.edges[cells.edge]
    upper, lower, direction = edges.upper.tolist(), edges.lower.tolist(), edges.direction.tolist()
    at: dict[tuple[int, ...], list[int]] = {}
    for index, square in enumerate(upper):
        at.setdefault(tuple(square), []).append(index)
    found = set()
    kind = cells.template.tolist()
    for index, (plane, y, x) in enumerate(upper):
        for axis, beside in enumerate(((plane, y, x + 1), (plane, y + 1, x))):
            for other in at.get(beside, ()):
                if direction[other] == direction[index]:
                    found.add((axis, kind[index], kind[other], True))
        for other in at.get(tuple(lower[index]), ()):
            found.add((2, kind[other], kind[index], kind[index] == kind[other]))
    return found


class _Ports:
    """Sections of templates with the sides of the cube, computed when first needed."""

    def __init__(self, templates: tuple[Template, ...]) -> None:
        self.templates = templates
        self._sections: dict[tuple[int, int], CrossSection] = {}

    def section(self, template: int, side: int) -> "CrossSection":
        """Return the part of a template in a side, seen along the axis."""
        if (template, side) not in self._sections:
            self._sections[template, side] = _section(self.templates[template], side)
        return self._sections[template, side]

    def judge(self, axis: int, low: int, high: int, same: bool) -> list[Violation]:
        """Judge the high side of one template against the low side of another.

        Parameters
        ----------
        axis
            Axis across the common side.
        low, high
            Templates on both sides.
        same
            Whether both sections must be equal.
        """
        if self.templates[low].surface or self.templates[high].surface:
            return self._judge_sheets(axis, low, high, same)
        ours, theirs = self.section(low, 2 * axis + 1), self.section(high, 2 * axis)
        areas = float(ours.area()), float(theirs.area())
        common = float((ours ^ theirs).area())
        apart = axis != 2 and min(areas) < SNAP
        if same and not apart and sum(areas) - 2.0 * common > LARGEST_DIFFERENCE * max(*areas, 1e-12) + SNAP:
            return [self._differs(axis, low, high, areas, common)]
        if (axis == 2 and common < SMALLEST_CONTACT * min(areas) - SNAP) or (axis == 2 and min(areas) < SNAP):
            names = self.templates[high].name, self.templates[low].name
            found = f"{names[0]} does not stand on {names[1]}: they share {common:.2%} of the square"
            return [Violation(PORTS, self.templates[high].name, found)]
        return []

    def _differs(
        self, axis: int, low: int, high: int, areas: tuple[float, float], common: float
    ) -> Violation:
        here, there = SIDE_NAMES[2 * axis + 1], SIDE_NAMES[2 * axis]
        message = (
            f"its {here} side covers {areas[0]:.2%} of the square, the {there} side of the adjacent "
            f"{self.templates[high].name} covers {areas[1]:.2%}, and both share {common:.2%}"
        )
        return Violation(PORTS, self.templates[low].name, message)

    def _judge_sheets(self, axis: int, low: int, high: int, same: bool) -> list[Violation]:
        """Judge sheets, which end in lines: two sheets above each other must share a corner."""
        if not (self.templates[low].surface and self.templates[high].surface):
            return []
        ours, theirs = (_corners(self.templates[each], 2 * axis + end) for each, end in ((low, 1), (high, 0)))
        differ = ours != theirs if same else axis == 2 and not ours & theirs
        if not differ:
            return []
        message = (
            f"its edges on the {SIDE_NAMES[2 * axis + 1]} side are not those of {self.templates[high].name}"
        )
        return [Violation(PORTS, self.templates[low].name, message)]


def _section(template: Template, side: int) -> "CrossSection":
    from manifold3d import CrossSection, FillRule

    points = snapped(template.mesh.vertices)
    triangles = template.mesh.triangles.astype(np.int64)
    flush = triangles[flush_sides(points, triangles) == side]
    plan = points[flush][:, :, list(PLANE_AXES[side // 2])]
    turned = plan if side % 2 else plan[:, ::-1]  # triangles of a low side are seen from inside
    return CrossSection([np.ascontiguousarray(each) for each in turned], FillRule.Positive)


def _corners(template: Template, side: int) -> set[tuple[float, ...]]:
    points = np.round(snapped(template.mesh.vertices), 5)
    axis = side // 2
    flush = points[points[:, axis] == float(side % 2)]
    return set(map(tuple, flush[:, list(PLANE_AXES[axis])].tolist()))
