"""The voxels of a build and the red squares to connect, as a network that any router can be asked to route."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bytes, Int64s, Ints, frozen
from amprep.checks.supports.plan import check_plan
from amprep.errors import PluginError
from amprep.geometry.voxels.grid import Grid
from amprep.model.control import Progress, Stop
from amprep.model.support_edges import SupportEdges, square_keys
from amprep.model.supports import ENCLOSED, OUT_OF_TIME, Escalation, SupportPlan, SupportProblem, Voxel
from amprep.supports.grid.red_squares import RedSquares
from amprep.validation import LARGEST_COUNT

Route = Callable[[SupportProblem, Stop, Progress], SupportPlan]
"""A router: called with a problem, a stop and a progress callback, it returns a plan."""

NO_VOXELS = frozen([], np.int32, 3)
"""An empty list ``(0, 3)`` of voxels."""


class Rules(NamedTuple):
    """What holds for every network: capacities (0: none) and the rest as in `SupportProblem`.

    Attributes
    ----------
    load_area
        mm2 of overhang that one edge may carry; 0 for any.
    load_height
        mm up to which a support carries that much; a taller one carries less by the square of the height, as
        columns that buckle do (Euler). 0: any height.
    """

    edge_capacity: int
    node_capacity: int
    costs: tuple[int, int]
    material: tuple[float, float]
    escalation: Escalation = "none"
    load_area: float = 0.0
    load_height: float = 0.0

    def edge_limit(self, frame: Grid, top: int) -> int:
        """Return the capacity of edges in a network whose highest red square is in plane `top`; 0 for none.

        A path carries one square of overhang. At least one path may use an edge.
        """
        if not self.load_area:
            return self.edge_capacity
        height = top * frame.step
        weaker = min(1.0, self.load_height / height) ** 2 if self.load_height and height else 1.0
        by_load = max(1, int(min(self.load_area * weaker / frame.pitch**2 + 1e-9, LARGEST_COUNT)))
        return min(by_load, self.edge_capacity or by_load)


class Posed(NamedTuple):
    """A problem in the block of voxels that paths can reach.

    Attributes
    ----------
    corner
        ``(3,)`` plane, y, x of the block's first voxel in the grid.
    number
        ``(n,)`` which of the problem's red squares each one asked for is; parts may share some.
    """

    problem: SupportProblem
    corner: Ints
    number: Int64s


class Network:
    """The voxels of a build and the red squares to connect, ready to be routed by any of the routers.

    Attributes
    ----------
    reasons
        Of each red square: why it is not connected, ``""`` when it is.
    notes
        What the user should know of the routing so far, each with the part that it is about, None for several.
    """

    def __init__(
        self, frame: Grid, voxels: Bytes, red: RedSquares, rules: Rules, route: Route, stop: Stop
    ) -> None:
        self.frame, self.voxels, self.red = frame, voxels, red
        self.rules, self.route, self.stop = rules, route, stop
        self.reasons = [""] * len(red.part)
        self.notes: list[tuple[int | None, str]] = []

    def connect(self, reds: Ints, closed: Ints, stop: Stop, progress: Progress) -> SupportEdges:
        """Route the red squares numbered `reds` with the voxels ``closed[:, :3]`` (k, y, x) closed for once.

        Notes the reasons of those that stay unconnected, and returns the edges; without time nothing is routed.
        """
        shut = np.isin(square_keys(voxels_below(self.red.square[reds])), square_keys(closed))
        self.explain(reds[shut], ENCLOSED)
        reds = reds[~shut]
        if len(reds) and stop():
            self.explain(reds, OUT_OF_TIME)
            self._note((f"routing ended early: {stop.reason}",), reds)
        if not len(reds) or stop():
            return SupportEdges.from_rows([])
        posed = self.pose(reds, closed)
        plan = self.route(posed.problem, stop, progress)
        broken = check_plan(posed.problem, plan)
        if broken:
            raise PluginError(
                f"the support router broke its promise: {broken[0].subject} {broken[0].message}"
            )
        return self.read(plan, posed, reds)

    def pose(self, reds: Ints, closed: Ints) -> Posed:
        """Return the problem of connecting `reds`, one or more: a path from plane p strays at most p squares."""
        _, first, number = np.unique(
            square_keys(self.red.square[reds]), return_index=True, return_inverse=True
        )
        square = self.red.square[reds[first]]
        top = int(square[:, 0].max())
        _, ny, nx = self.frame.shape
        y, x = _stretch(square[:, 1], top, ny), _stretch(square[:, 2], top, nx)
        voxels = self.voxels[: top + 1, y, x].copy()
        corner = np.array([0, y.start, x.start], np.int32)
        inner = closed - corner
        inner = inner[((inner >= 0) & (inner < voxels.shape)).all(axis=1)]
        voxels[tuple(inner.T)] = Voxel.CLOSED
        return Posed(self._problem(voxels, square - corner, reds[first], corner), corner, number)

    def read(self, plan: SupportPlan, posed: Posed, reds: Ints) -> SupportEdges:
        """Note what a plan says of the red squares it was asked for, and return its edges."""
        words = list(plan.notes)
        if plan.raised and self.rules.escalation != "none":
            words.append(f"capacities are raised by up to {plan.raised}, as supports.escalation allows")
        if plan.stop_reason != "finished":
            words.append(f"routing ended early: {plan.stop_reason}")
        self._note(words, reds)
        reason = {each.red: each.reason for each in plan.unconnected}
        for red, i in zip(reds, posed.number.tolist(), strict=True):
            self.reasons[red] = reason.get(i, "")
        _, y, x = posed.corner
        return replace(plan.edges, y=plan.edges.y + y, x=plan.edges.x + x)

    def explain(self, reds: Ints, reason: str) -> None:
        """Note why red squares are not connected."""
        for red in reds:
            self.reasons[red] = reason

    def unconnected(self, *reasons: str) -> Ints:
        """Return the numbers of the unconnected red squares; with `reasons`, of those with one of these reasons."""
        return np.flatnonzero([each in reasons if reasons else each != "" for each in self.reasons]).astype(
            np.int32
        )

    def _note(self, words: Sequence[str], reds: Ints) -> None:
        """Keep sentences about the parts of red squares, each once."""
        parts = np.unique(self.red.part[reds])
        notes = [(int(parts[0]) if len(parts) == 1 else None, each) for each in words]
        self.notes += [note for note in notes if note not in self.notes]

    def _problem(self, voxels: Bytes, square: Ints, reds: Ints, corner: Ints) -> SupportProblem:
        frame, rules = self.frame, self.rules
        origin = frame.origin + corner[::-1] * (frame.pitch, frame.pitch, frame.step)
        nz, ny, nx = voxels.shape
        return SupportProblem(
            Grid(origin, frame.pitch, frame.step, (nz, ny, nx)),
            voxels,
            square,
            self.red.part[reds],
            self.red.region[reds],
            voxels[0] == Voxel.FREE,
            rules.edge_limit(frame, int(square[:, 0].max())),
            rules.node_capacity,
            rules.costs,
            rules.material,
            rules.escalation,
        )


def voxels_below(square: Ints) -> Ints:
    """Return the voxel (k, y, x) below each square."""
    return np.asarray(square - (1, 0, 0), np.int32)


def _stretch(values: Ints, margin: int, limit: int) -> slice:
    return slice(max(int(values.min()) - margin, 0), min(int(values.max()) + margin + 1, limit))
