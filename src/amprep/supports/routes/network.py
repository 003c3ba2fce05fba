"""Pose support problems on the grid of a build, call the router, and keep the reasons and notes of its plans."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s, Ints, frozen
from amprep.checks.supports.plan import check_plan
from amprep.errors import PluginError
from amprep.flows.reachability import find_reachable
from amprep.geometry.voxels.grid import Grid
from amprep.model.control import Progress, Stop
from amprep.model.supports import (
    ENCLOSED,
    OUT_OF_TIME,
    TERRITORY,
    SupportPlan,
    SupportProblem,
    Unconnected,
    Voxel,
)
from amprep.model.supports.edges import SupportEdges, square_keys
from amprep.supports.grid.red_squares import RedSquares, SupportGrid
from amprep.supports.grid.territory import PartTerritory
from amprep.supports.routes.drifting import reroute_drifting
from amprep.supports.routes.straightening import straighten
from amprep.supports.rules import PlanningRules

Route = Callable[[SupportProblem, Stop, Progress], SupportPlan]
"""A router: called with a problem, a stop and a progress callback, it returns a plan."""

NO_VOXELS = frozen([], np.int32, 3)
"""An empty list ``(0, 3)`` of voxels."""


class PosedProblem(NamedTuple):
    """A support problem on the block of voxels that paths can reach.

    Attributes
    ----------
    corner
        ``(3,)`` plane, y, x of the block's first voxel in the grid.
    number
        ``(n,)`` index of each requested red square in the problem; red squares of several parts may share one.
    """

    problem: SupportProblem
    corner: Ints
    number: Int64s


class SupportNetwork:
    """The red squares of a build and the router that connects them.

    Attributes
    ----------
    red
        All red squares of the build.
    territories
        Where the supports of each part may be; none where parts share all space.
    reasons
        For each red square, why it is unconnected; ``""`` when it is connected.
    notes
        Sentences for the user about the routing, each with the part it concerns; None for several parts.
    """

    def __init__(
        self,
        laid: SupportGrid,
        rules: PlanningRules,
        material: tuple[float, float],
        route: Route,
        stop: Stop,
        territories: Sequence[PartTerritory] = (),
    ) -> None:
        self.laid, self.red, self.territories = laid, laid.red, territories
        self.rules, self.material, self.route, self.stop = rules, material, route, stop
        self.reasons = [""] * len(self.red.part)
        self.notes: list[tuple[int | None, str]] = []

    def only(self, chosen: Bools) -> "SupportNetwork":
        """Return a network of the chosen red squares ``(m,)`` alone, in which nothing is routed."""
        laid = self.laid._replace(red=RedSquares(*(each[chosen] for each in self.red)))
        territories = tuple(
            each._replace(reachable=each.reachable[chosen[self.red.part == part]])
            for part, each in enumerate(self.territories)
        )
        return SupportNetwork(laid, self.rules, self.material, self.route, self.stop, territories)

    def reachable(self) -> Bools:
        """Tell which red squares ``(m,)`` have a path to the plate, or are on it."""
        found = np.asarray(self.red.square[:, 0] == 0)
        for own in self.groups(np.flatnonzero(~found).astype(np.int32)):
            if not len(own):
                continue
            posed = self.pose(own, NO_VOXELS)
            found[own] = find_reachable(posed.problem)[posed.number] & ~self.are_blocked(own, NO_VOXELS)
        return found

    def connect(self, red_squares: Ints, closed: Ints, stop: Stop, progress: Progress) -> SupportEdges:
        """Route red squares, with further voxels closed, and note why red squares stay unconnected.

        Parameters
        ----------
        red_squares
            ``(n,)`` numbers of the red squares to connect; of one part where parts have territories.
        closed
            ``(k, 3)`` k, y, x of the voxels that are closed in this problem only.
        stop
            Ends the routing; if it says stop already, no edge is returned.
        progress
            Progress callback.

        Raises
        ------
        PluginError
            If the router returns a plan that `check_plan` rejects.
        """
        blocked = self.are_blocked(red_squares, closed)
        self.explain(red_squares[blocked], ENCLOSED)
        red_squares = red_squares[~blocked]
        if len(red_squares) and stop():
            self.explain(red_squares, OUT_OF_TIME)
            self._note((f"routing ended early: {stop.reason}",), red_squares)
        if not len(red_squares) or stop():
            return SupportEdges.from_rows([])
        posed = self.pose(red_squares, closed)
        plan = self.route(posed.problem, stop, progress)
        violations = check_plan(posed.problem, plan)
        if violations:
            first = violations[0]
            raise PluginError(
                f"the support router broke its promise: {first.subject} {first.message}; choose another by --router"
            )
        if self.territories:
            plan = self._straightened(plan, posed, red_squares)
        return self.read(plan, posed, red_squares)

    def pose(self, red_squares: Ints, closed: Ints, *, anywhere: bool = False) -> PosedProblem:
        """Return the problem of connecting one or more red squares.

        A path from plane p moves sideways by at most p squares, which bounds the block of voxels; so does the territory
        of the part, unless paths may lead `anywhere`.
        """
        keys = square_keys(self.red.square[red_squares])
        _, first, number = np.unique(keys, return_index=True, return_inverse=True)
        square = self.red.square[red_squares[first]]
        top = int(square[:, 0].max())
        _, ny, nx = self.laid.grid.shape
        y, x = _range_around(square[:, 1], top, ny), _range_around(square[:, 2], top, nx)
        territory = None if anywhere else self._territory_of(red_squares)
        if territory is not None:
            y, x = (_common(*each) for each in zip((y, x), territory.slices, strict=True))
        voxels = self.laid.voxels[: top + 1, y, x].copy()
        corner = np.array([0, y.start, x.start], np.int32)
        if territory is not None:
            _, first_y, first_x = corner - (0, *territory.first)
            opened = territory.opened[: top + 1, first_y:, first_x:][:, : voxels.shape[1], : voxels.shape[2]]
            voxels[~opened & (voxels == Voxel.FREE)] = Voxel.CLOSED
        inner = closed - corner
        inner = inner[((inner >= 0) & (inner < voxels.shape)).all(axis=1)]
        voxels[tuple(inner.T)] = Voxel.CLOSED
        grid, rules = self.laid.grid, self.rules
        nz, ny, nx = voxels.shape
        problem = SupportProblem(
            Grid(grid.origin + corner[::-1] * grid.size, grid.pitch, grid.step, (nz, ny, nx)),
            voxels,
            square - corner,
            self.red.part[red_squares[first]],
            self.red.region[red_squares[first]],
            voxels[0] == Voxel.FREE,
            rules.edge_limit(grid, top),
            rules.node_capacity,
            (rules.vertical_cost, rules.oblique_cost),
            self.material,
            rules.escalation,
        )
        return PosedProblem(problem, corner, number)

    def read(self, plan: SupportPlan, posed: PosedProblem, red_squares: Ints) -> SupportEdges:
        """Keep the reasons and notes of a plan for the requested red squares; return its edges in the whole grid."""
        sentences = list(plan.notes)
        if plan.raised and self.rules.escalation != "none":
            sentences.append(f"capacities are raised by up to {plan.raised}, as supports.escalation allows")
        if plan.stop_reason != "finished":
            sentences.append(f"routing ended early: {plan.stop_reason}")
        self._note(sentences, red_squares)
        reason = {each.red: each.reason for each in plan.unconnected}
        for red, i in zip(red_squares, posed.number.tolist(), strict=True):
            self.reasons[red] = reason.get(i, "")
        _, y, x = posed.corner
        return replace(plan.edges, y=plan.edges.y + y, x=plan.edges.x + x)

    def explain(self, red_squares: Ints, reason: str) -> None:
        """Note why red squares are unconnected."""
        for red in red_squares:
            self.reasons[red] = reason

    def unconnected(self, *reasons: str) -> Ints:
        """Return the numbers of the unconnected red squares; with `reasons`, of those with one of these reasons."""
        chosen = [each in reasons if reasons else each != "" for each in self.reasons]
        return np.flatnonzero(chosen).astype(np.int32)

    def _straightened(self, plan: SupportPlan, posed: PosedProblem, red_squares: Ints) -> SupportPlan:
        """Return a plan without detours and without paths that drift too far."""
        problem, limits = posed.problem, self.territories[self.red.part[red_squares[0]]].limits
        edges = straighten(problem, plan.edges)
        left = np.array([each.red for each in plan.unconnected], np.int64)
        connected = np.setdiff1d(np.arange(len(problem.red)), left)
        edges, lost = reroute_drifting(problem, edges, connected, limits)
        unconnected = plan.unconnected + tuple(Unconnected(red, ENCLOSED) for red in lost.tolist())
        return replace(plan, edges=edges, unconnected=unconnected)

    def explain_territories(self) -> None:
        """Note which of the enclosed red squares have a path that is outside the territory of their part."""
        left = self.unconnected(ENCLOSED)
        if self.territories and left.size:
            posed = self.pose(left, NO_VOXELS, anywhere=True)
            self.explain(left[find_reachable(posed.problem)[posed.number]], TERRITORY)

    def groups(self, red_squares: Ints) -> Iterator[Ints]:
        """Yield red squares that may share paths: all of them, or part by part where parts have territories."""
        if not self.territories:
            yield red_squares
            return
        part = self.red.part[red_squares]
        yield from (red_squares[part == each] for each in np.unique(part))

    def _territory_of(self, red_squares: Ints) -> PartTerritory | None:
        return self.territories[self.red.part[red_squares[0]]] if self.territories else None

    def are_blocked(self, red_squares: Ints, closed: Ints) -> Bools:
        """Tell which red squares have a closed voxel below them, or no path in the territory of their part."""
        below = voxels_below(self.red.square[red_squares])
        blocked = np.isin(square_keys(below), square_keys(closed))
        if not self.territories or not len(red_squares):
            return blocked
        part = int(self.red.part[red_squares[0]])
        territory = self.territories[part]
        number = red_squares - int(np.searchsorted(self.red.part, part))
        return blocked | ~territory.allows(below) | ~territory.reachable[number]

    def _note(self, sentences: Sequence[str], red_squares: Ints) -> None:
        """Keep sentences about the parts of red squares, each once."""
        parts = np.unique(self.red.part[red_squares])
        notes = [(int(parts[0]) if len(parts) == 1 else None, each) for each in sentences]
        self.notes += [note for note in notes if note not in self.notes]


def voxels_below(square: Ints) -> Ints:
    """Return the voxel (k, y, x) below each square ``(n, 3)``."""
    return np.asarray(square - (1, 0, 0), np.int32)


def _range_around(values: Ints, margin: int, limit: int) -> slice:
    """Return the range of indices from the smallest to the largest value, widened by `margin`, within the grid."""
    return slice(max(int(values.min()) - margin, 0), min(int(values.max()) + margin + 1, limit))


def _common(one: slice, other: slice) -> slice:
    """Return the indices that are in both ranges."""
    return slice(max(one.start, other.start), min(one.stop, other.stop))
