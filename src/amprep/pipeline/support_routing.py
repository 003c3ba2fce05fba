"""Routes the red squares of a build: as one network, or part by part so that supports are not shared."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.checks.supports import check_plan
from amprep.errors import PluginError
from amprep.geometry.overhangs import Longs
from amprep.job.settings import LARGEST_COUNT
from amprep.model.arrays import Bytes, Ints
from amprep.model.control import Report, Stop, silent
from amprep.model.supports import (
    CAPACITY,
    DIRECTIONS,
    ENCLOSED,
    Cube,
    Escalation,
    GridFrame,
    SupportPlan,
    SupportProblem,
)
from amprep.pipeline.support_red import RedSquares

Route = Callable[[SupportProblem, Stop, Report], SupportPlan]


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

    def edge_limit(self, frame: GridFrame, top: int) -> int:
        """Return the capacity of edges in a network whose highest red square is in plane `top`; 0 for none.

        A path carries one square of overhang. At least one path may use an edge.
        """
        if not self.load_area:
            return self.edge_capacity
        height = top * frame.step
        weaker = min(1.0, self.load_height / height) ** 2 if self.load_height and height else 1.0
        by_load = max(1, int(min(self.load_area * weaker / frame.pitch**2 + 1e-9, LARGEST_COUNT)))
        return min(by_load, self.edge_capacity or by_load)


class Routed(NamedTuple):
    """Where the supports run.

    Attributes
    ----------
    edges
        ``(n, 7)`` int32: plane, y, x, direction, flow, capacity, part; edges of several plans may repeat.
    reasons
        For each red square; ``""`` when it is connected.
    """

    edges: Ints
    reasons: tuple[str, ...]


class Network:
    """The cubes of a build and the red squares to connect, ready to be routed by any of the routers.

    Attributes
    ----------
    notes
        What the user should know of the routing so far, each with the part that it is about, None for several.
    """

    def __init__(
        self, frame: GridFrame, cubes: Bytes, red: RedSquares, rules: Rules, route: Route, stop: Stop
    ) -> None:
        self.frame, self.cubes, self.red, self.rules, self.route, self.stop = (
            frame,
            cubes,
            red,
            rules,
            route,
            stop,
        )
        self.reasons = [""] * len(red.part)
        self.notes: list[tuple[int | None, str]] = []

    def connect(self, reds: Ints, closed: Ints, report: Report) -> Ints:
        """Route the red squares numbered `reds` with the cubes ``closed[:, :3]`` (k, y, x) closed for once.

        Notes the reasons of those that stay unconnected, and returns the edges. The router sees only the
        block of cubes that paths can reach: one from plane p strays at most p squares.
        """
        shut = np.isin(_keys(_below(self.red.square[reds])), _keys(closed))
        for red in reds[shut]:
            self.reasons[red] = ENCLOSED
        reds = reds[~shut]
        _, first, number = np.unique(_keys(self.red.square[reds]), return_index=True, return_inverse=True)
        square = self.red.square[reds[first]]
        if not len(square):
            return np.empty((0, 7), np.int32)
        top = int(square[:, 0].max())
        _, ny, nx = self.frame.shape
        y, x = _stretch(square[:, 1], top, ny), _stretch(square[:, 2], top, nx)
        cubes = self.cubes[: top + 1, y, x].copy()
        corner = np.array([0, y.start, x.start], np.int32)
        inner = closed - corner
        inner = inner[((inner >= 0) & (inner < cubes.shape)).all(axis=1)]
        cubes[tuple(inner.T)] = Cube.CLOSED
        problem = self._problem(cubes, square - corner, reds[first], corner)
        plan = self.route(problem, self.stop, report)
        broken = check_plan(problem, plan)
        if broken:
            raise PluginError(
                f"the support router broke its promise: {broken[0].subject} {broken[0].message}"
            )
        self._note(plan, reds)
        reason = {each.red: each.reason for each in plan.unconnected}
        for red, i in zip(reds, number, strict=True):
            self.reasons[red] = reason.get(int(i), "")
        rows = (plan.plane, plan.y + corner[1], plan.x + corner[2], plan.direction, plan.flow, plan.capacity)
        return np.column_stack([*rows, np.zeros(len(plan.flow))]).astype(np.int32)

    def _note(self, plan: SupportPlan, reds: Ints) -> None:
        """Keep what the router says, that it raised capacities, and that it was stopped."""
        words = list(plan.notes)
        if plan.raised:
            words.append(f"capacities are raised by up to {plan.raised}, as supports.escalation allows")
        if plan.stop_reason != "finished":
            words.append(f"routing ended early: {plan.stop_reason}")
        parts = np.unique(self.red.part[reds])
        notes = [(int(parts[0]) if len(parts) == 1 else None, each) for each in words]
        self.notes += [note for note in notes if note not in self.notes]

    def _problem(self, cubes: Bytes, square: Ints, reds: Ints, corner: Ints) -> SupportProblem:
        frame, rules = self.frame, self.rules
        origin = frame.origin + corner[::-1] * (frame.pitch, frame.pitch, frame.step)
        nz, ny, nx = cubes.shape
        return SupportProblem(
            GridFrame(origin, frame.pitch, frame.step, (nz, ny, nx)),
            cubes,
            square,
            self.red.part[reds],
            self.red.region[reds],
            cubes[0] == Cube.WHITE,
            rules.edge_limit(frame, int(square[:, 0].max())),
            rules.node_capacity,
            rules.costs,
            rules.material,
            rules.escalation,
        )


def _stretch(values: Ints, margin: int, limit: int) -> slice:
    return slice(max(int(values.min()) - margin, 0), min(int(values.max()) + margin + 1, limit))


def route_together(network: Network, report: Report) -> Routed:
    """Route everything as one network, as in the thesis: supports of different parts may merge."""
    reds = np.flatnonzero(network.red.square[:, 0] > 0).astype(np.int32)
    edges = network.connect(reds, _no_cubes(), report)
    edges[:, 6] = _part_of_edges(edges, network.red, reds)
    return Routed(edges, tuple(network.reasons))


def route_apart(network: Network, report: Report) -> Routed:
    """Route part by part; squares and cubes in use are closed to the parts that follow.

    Parts come by the height of their highest red square, lowest first: the less height, the less room to
    give way. Cubes right below the red squares of other parts are kept free for these. Red squares that stay
    unconnected are then routed once more with the cubes of other supports open: they share where they must.
    """
    red = network.red
    above = red.square[:, 0] > 0
    parts = sorted(
        set(red.part[above].tolist()), key=lambda part: (int(red.square[red.part == part, 0].max()), part)
    )
    blocks = [np.empty((0, 7), np.int32)]
    for done, part in enumerate(parts):
        own = np.flatnonzero(above & (red.part == part)).astype(np.int32)
        kept = _below(red.square[above & (red.part != part)])
        kept = kept[~np.isin(_keys(kept), _keys(_below(red.square[own])))]
        closed = np.concatenate([kept, *(_cubes_used(block) for block in blocks)])
        edges = network.connect(own, closed, silent)
        edges[:, 6] = part
        blocks.append(edges)
        report((done + 1) / (len(parts) + 1), "routing part by part")
    blocks.append(_share(network, np.concatenate(blocks)))
    return Routed(np.concatenate(blocks), tuple(network.reasons))


def _share(network: Network, edges: Ints) -> Ints:
    """Connect the red squares left over through the cubes of other supports, within the capacities.

    What these leave out exceeds them at last, when escalation is allowed.
    """
    rules = network.rules
    network.rules = rules._replace(escalation="none")
    more = _share_within(network, edges)
    network.rules = rules
    left = np.flatnonzero([reason == CAPACITY for reason in network.reasons]).astype(np.int32)
    if rules.escalation == "none" or not left.size:
        return more
    rest = network.connect(left, _no_cubes(), silent)
    rest[:, 6] = _part_of_edges(rest, network.red, left)
    return np.concatenate([more, rest])


def _share_within(network: Network, edges: Ints) -> Ints:
    """Connect the red squares left over through the cubes of other supports, with no capacity exceeded.

    The router does not know the flow that is there already, so squares where both together exceed a capacity
    are closed and the rest is routed again, until nothing is exceeded.
    """
    left = np.flatnonzero([reason != "" for reason in network.reasons]).astype(np.int32)
    closed = _no_cubes()
    while left.size:
        more = network.connect(left, closed, silent)
        more[:, 6] = _part_of_edges(more, network.red, left)
        if not len(closed):
            enclosed = {int(red) for red in left if network.reasons[red] == ENCLOSED}
        for red in left:
            if network.reasons[red] and int(red) not in enclosed:
                network.reasons[red] = CAPACITY
        limit = network.rules.edge_limit(network.frame, int(network.red.square[:, 0].max()))
        full = _exceeded(np.concatenate([edges, more]), limit, network.rules.node_capacity)
        full = full[np.isin(_keys(full), _keys(_below(more[:, :3])))]
        if not len(full):
            return more
        closed = np.concatenate([closed, full])
    return np.empty((0, 7), np.int32)


def _exceeded(edges: Ints, edge_capacity: int, node_capacity: int) -> Ints:
    """Return the cubes below the squares, and below the edges' upper squares, that exceed the capacities."""
    merged = merge_edges(edges)
    over = np.zeros(len(merged), np.bool_)
    if edge_capacity:
        over |= merged[:, 4] > edge_capacity
    if node_capacity:
        _, square = np.unique(_keys(merged[:, :3]), return_inverse=True)
        over |= np.bincount(square, weights=merged[:, 4])[square] > node_capacity
    return _below(merged[over, :3])


def merge_edges(edges: Ints) -> Ints:
    """Return each edge once, sorted: flows added, the greatest capacity, the first part."""
    key = _keys(edges[:, :3]) * len(DIRECTIONS) + edges[:, 3]
    _, first, same = np.unique(key, return_index=True, return_inverse=True)
    flow = np.bincount(same, weights=edges[:, 4]).astype(np.int32)
    capacity = flow.copy()
    np.maximum.at(capacity, same, edges[:, 5])
    return np.column_stack([edges[first, :4], flow, capacity, edges[first, 6]]).astype(np.int32)


def _keys(square: Ints) -> Longs:
    """Return a number for each square ``(n, 3)``, in the order of plane, y, x."""
    plane, y, x = square.T.astype(np.int64)
    return np.asarray((plane << 40) | (y << 20) | x)


def lower_squares(edges: Ints) -> Ints:
    """Return the square ``(n, 3)`` plane, y, x at the lower end of each edge."""
    step = np.array(DIRECTIONS, np.int32)[edges[:, 3]]
    return edges[:, :3] + np.column_stack([np.full(len(edges), -1), step]).astype(np.int32)


def _cubes_used(edges: Ints) -> Ints:
    """Return the two cubes (k, y, x) of each edge: below its upper square, above its lower one."""
    return np.stack([edges[:, :3] - (1, 0, 0), lower_squares(edges)], axis=1).reshape(-1, 3).astype(np.int32)


def cube_users(edges: Ints) -> dict[tuple[int, int, int], int]:
    """Return the cubes (k, y, x) that edges (rows as in `Routed.edges`) use, each with a part whose they are."""
    parts = np.repeat(edges[:, 6], 2).tolist()
    return {(k, y, x): part for (k, y, x), part in zip(_cubes_used(edges).tolist(), parts, strict=True)}


def _below(square: Ints) -> Ints:
    return np.asarray(square - (1, 0, 0), np.int32)


def _no_cubes() -> Ints:
    return np.empty((0, 3), np.int32)


def _part_of_edges(edges: Ints, red: RedSquares, reds: Ints) -> Ints:
    """Return for each edge the least part whose red square's support it belongs to (connected squares)."""
    component, of_red = components(edges, red.square[reds])
    least = np.full(int(max(component.max(initial=-1), of_red.max(initial=-1))) + 1, np.iinfo(np.int32).max)
    np.minimum.at(least, of_red, red.part[reds])
    return least[component].astype(np.int32)


def components(edges: Ints, squares: Ints) -> tuple[Ints, Ints]:
    """Label the connected supports: of each edge, and of each of `squares` ``(m, 3)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    upper, lower = edges[:, :3], lower_squares(edges)
    _, number = np.unique(_keys(np.concatenate([upper, lower, squares])), return_inverse=True)
    count, n = int(number.max(initial=-1)) + 1, len(edges)
    graph = coo_array((np.ones(n, np.int8), (number[:n], number[n : 2 * n])), shape=(count, count))
    label = connected_components(graph, directed=False)[1] if count else np.empty(0, np.int32)
    return label[number[:n]], label[number[2 * n :]]
