"""The promise that neighbours match: what of a cell meets a side is met by its neighbour there."""

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

MOST_DIFFERENT = 0.05
"""Share of the larger port by which two may differ: struts that come at a flat angle leave the ball a little."""

LEAST_HELD = 0.25
"""Share of the smaller port that has to stand on the other one where the way bends or the cell changes."""


def check_ports(request: CellRequest, cells: Cells) -> list[Violation]:
    """Judge every pair of neighbours of the answer, each pair of templates once.

    Side by side under one map, both have to look the same on the common side, unless one keeps away from it. One
    on another, they have to stand on one another; when the templates are the same, they have to look the same too.
    """
    ports = _Ports(cells.templates)
    found = [
        violation
        for axis, low, high, same in sorted(_neighbours(request, cells))
        for violation in ports.judge(axis, low, high, same)
    ]
    return list(dict.fromkeys(found))


def port_areas(template: Template) -> Floats:
    """Return the share of each side that the template meets, ``(6,)`` in the order of `SIDE_NAMES`."""
    ports = _Ports((template,))
    return np.array([float(ports.section(0, side).area()) for side in range(6)])


def _neighbours(request: CellRequest, cells: Cells) -> set[tuple[int, int, int, bool]]:
    """List pairs of templates that meet: axis, the one at its low end, the one at its high end, whether alike."""
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
    """Sections of templates with the sides of the cube, made when they are first needed."""

    def __init__(self, templates: tuple[Template, ...]) -> None:
        self.templates = templates
        self._sections: dict[tuple[int, int], CrossSection] = {}

    def section(self, template: int, side: int) -> "CrossSection":
        """Return what of a template lies on a side, seen along the axis."""
        if (template, side) not in self._sections:
            self._sections[template, side] = _section(self.templates[template], side)
        return self._sections[template, side]

    def judge(self, axis: int, low: int, high: int, same: bool) -> list[Violation]:
        """Judge one pair: the high side of `low` against the low side of `high`."""
        if self.templates[low].surface or self.templates[high].surface:
            return self._judge_sheets(axis, low, high, same)
        ours, theirs = self.section(low, 2 * axis + 1), self.section(high, 2 * axis)
        areas = float(ours.area()), float(theirs.area())
        common = float((ours ^ theirs).area())
        apart = axis != 2 and min(areas) < SNAP
        if same and not apart and sum(areas) - 2.0 * common > MOST_DIFFERENT * max(*areas, 1e-12) + SNAP:
            return [self._differs(axis, low, high, areas, common)]
        if (axis == 2 and common < LEAST_HELD * min(areas) - SNAP) or (axis == 2 and min(areas) < SNAP):
            names = self.templates[high].name, self.templates[low].name
            found = f"{names[0]} does not stand on {names[1]}: {common:.2%} of the square in common"
            return [Violation(PORTS, self.templates[high].name, found)]
        return []

    def _differs(
        self, axis: int, low: int, high: int, areas: tuple[float, float], common: float
    ) -> Violation:
        here, there = SIDE_NAMES[2 * axis + 1], SIDE_NAMES[2 * axis]
        message = (
            f"its {here} side has {areas[0]:.2%} of the square, the {there} side of "
            f"{self.templates[high].name} above or beside it {areas[1]:.2%}, and {common:.2%} are the same"
        )
        return Violation(PORTS, self.templates[low].name, message)

    def _judge_sheets(self, axis: int, low: int, high: int, same: bool) -> list[Violation]:
        """Sheets end in lines: one on another, they have to have a corner in common."""
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
    turned = plan if side % 2 else plan[:, ::-1]  # a low side is seen from inside
    return CrossSection([np.ascontiguousarray(each) for each in turned], FillRule.Positive)


def _corners(template: Template, side: int) -> set[tuple[float, ...]]:
    points = np.round(snapped(template.mesh.vertices), 5)
    axis = side // 2
    flush = points[points[:, axis] == float(side % 2)]
    return set(map(tuple, flush[:, list(PLANE_AXES[axis])].tolist()))
