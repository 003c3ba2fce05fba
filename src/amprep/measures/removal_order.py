"""Find an order in which the parts of a build can be taken out, and the parts that are locked into each other."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from amprep.geometry.removal.blocking import Blocking
from amprep.geometry.removal.bodies import CollisionShape, MovableBody, movable_body
from amprep.geometry.removal.order import DIRECTIONS, RemovalOrder, find_removal_order, with_blockers
from amprep.model import Build

MOST_TRIANGLES = 3_000_000
"""Triangles of all trees together, which take 450 bytes each; the trees of single boxes are not needed."""


def measure_removal_order(build: Build, stop: Callable[[], bool] = lambda: False) -> RemovalOrder:
    """Return an order in which the parts of a build leave, by their indices.

    A part leaves together with its supports; parts that share a support leave together. Walls of the build volume block
    no motion. Parts are moved without turning. Where all parts are beside each other, as on a metal plate, the order
    states for each part which others must leave before.

    Parameters
    ----------
    build
        Parts and supports.
    stop
        Ends the search early; the parts that are left are unknown. The search also ends at `MOST_TRIANGLES`.
    """
    groups = _held_together(build)
    blocking = Blocking(_bodies(build, groups), DIRECTIONS)
    found = find_removal_order(blocking, lambda: stop() or blocking.triangles > MOST_TRIANGLES)
    if _is_flat(build) and not found.unknown:
        found = with_blockers(blocking, found)

    def parts(bodies: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(sorted(part for body in bodies for part in groups[body]))

    steps = (
        replace(
            step,
            bodies=parts(step.bodies),
            within=parts(step.within),
            after=None if step.after is None else parts(step.after),
        )
        for step in found.steps
    )
    return RemovalOrder(tuple(steps), tuple(map(parts, found.locked)), parts(found.unknown))


def _is_flat(build: Build) -> bool:
    """Tell whether all parts are beside each other: a horizontal plane cuts each of them."""
    bounds = [placed.mesh.bounds for placed in build.parts]
    return max((low[2] for low, _ in bounds), default=0.0) < min((high[2] for _, high in bounds), default=1.0)


def _held_together(build: Build) -> list[tuple[int, ...]]:
    """Return the parts that supports connect, as groups; a part without a shared support is a group of its own."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(build.parts)
    links = [(body.parts[0], part) for body in build.supports for part in body.parts[1:]]
    tails, heads = np.array(links, np.int64).reshape(-1, 2).T
    graph = coo_array((np.ones(len(links)), (tails, heads)), shape=(count, count))
    number, label = connected_components(graph, directed=False)
    return [tuple(np.flatnonzero(label == group).tolist()) for group in range(number)]


def _bodies(build: Build, groups: list[tuple[int, ...]]) -> list[MovableBody]:
    """Return a body for each group of parts, with their supports; copies of a part share their tree."""
    meshes = {id(placed.part.mesh): placed.part for placed in build.parts}
    shapes = {
        key: CollisionShape(part.mesh.vertices, part.mesh.triangles, part.is_solid)
        for key, part in meshes.items()
    }
    bodies = []
    for group in groups:
        parts = [build.parts[index] for index in group]
        placed = [(shapes[id(each.part.mesh)], each.matrix) for each in parts]
        placed += [
            (CollisionShape(body.mesh.vertices, body.mesh.triangles, not body.surface), np.eye(4))
            for body in build.supports
            if len(body.mesh.triangles) and set(body.parts) & set(group)
        ]
        bodies.append(movable_body(placed))
    return bodies
