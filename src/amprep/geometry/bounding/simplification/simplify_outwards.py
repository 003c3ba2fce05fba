"""Simplify a closed mesh so that the result contains it (thesis 2.5).

After Gaschler, Fischer and Knoll, *The bounding mesh algorithm*, TUM technical report I1522, 2015.

Strategy
--------
An edge is contracted to a new vertex on the outer side of the planes of all triangles around the edge.

*Containment.* The winding number of a closed oriented surface counts how often it encloses a point.
Contracting an edge to w replaces the triangles f around the edge by a fan. Both have the same border,
and the tetrahedra (f, w) fill the space between them: the boundary of their sum is the fan minus the
triangles. w is on the outer side of each f, so each tetrahedron counts positively, and the winding
number becomes greater or stays, everywhere. It is at least 1 in the solid at the start, so it is at
least 1 there at the end, whatever the surface looks like. w keeps a margin from the planes that exceeds
the rounding errors. Only the ends of the edge themselves need none, because most of their tetrahedra are
flat.

*A clean solid.* The link condition keeps the surface a manifold. A contraction whose fan would meet
another triangle or itself is refused; a tree of boxes finds the triangles near the fan. So a surface
that does not intersect itself never does, its winding number is 0 or 1, and the volume of the result is
the volume at the start plus the volumes added.

*Cost.* The volume that a contraction adds is linear in w, so the best w is the solution of a linear
program in three unknowns (progressive hulls: Sander, Gu, Gortler, Hoppe, Snyder 2000, DOI
10.1145/344779.344935), made unique by a small preference for the middle of the edge. It is the growth
that counts for packing, and the costs of all contractions add up to it. The cost of the paper, the sum
of the squared distances to the planes, is the other choice; it is a quadratic program.

*Order.* A heap holds the edges by cost. After a contraction the edges of the new triangles are evaluated
again; costs farther away may be out of date, so the cheapest edge is evaluated once more before it is
contracted.

*Distance.* With a limit of the distance, a fan must be within the limit of the original surface, which
is decided on the safe side for all its points, not for samples.

*Speed.* A contraction evaluates about 15 edges, each with about 10 planes, and visits a logarithmic
number of boxes.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.bounding.simplification.half_edges import make_half_edges
from amprep.geometry.bounding.simplification.moving_boxes import make_tree
from amprep.kernels.bounding.simplification.contract_edges import (
    ContractionState,
    contract_edges,
    fill_heap,
)
from amprep.kernels.bounding.simplification.edge_heap import EdgeHeap
from amprep.kernels.bounding.simplification.error_bound import OriginalSurface
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface
from amprep.kernels.bounding.simplification.patches import EdgePatch
from amprep.kernels.bounding.simplification.placement import ContractionRules

Cost = Literal["volume", "distance"]

_CHUNK = 2000
"""Contractions between two looks at the stop."""

_MOST_AROUND = 512
"""Greatest number of triangles around an edge that is contracted."""

_MARGIN = 1e-8
"""Margin to the planes, relative to the size of the mesh."""

_UNBOUNDED = 1e300


class SimplifiedMesh(NamedTuple):
    """A closed mesh that contains the original one.

    Attributes
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    reason
        Why the target was missed: empty if it is met, else ``stopped`` or ``no edge can be contracted``.
    """

    vertices: Floats
    triangles: Int64s
    reason: str


def simplify_outwards(
    mesh: MeshArrays,
    target: int,
    *,
    max_error: float = np.inf,
    cost: Cost = "volume",
    stop: Callable[[], bool] = lambda: False,
) -> SimplifiedMesh:
    """Contract edges until a target is met; the result contains the mesh.

    Parameters
    ----------
    mesh
        Vertices and triangles of a closed oriented mesh.
    target
        Number of triangles. It is missed if no edge can be contracted any more: handles, cavities and separate shells
        remain, and so do triangles in gaps that are too narrow.
    max_error
        Greatest distance (mm) of any point of the new surface from the surface of the mesh.
    cost
        ``volume``: contract the edge that adds the least volume; ``distance``: the one with the least sum of squared
        distances to the planes around it (the paper's cost).
    stop
        When it is true, the mesh so far is returned; it contains the original one.
    """
    surface = make_half_edges(*mesh)
    state, strict = _start(surface, max_error), _rules(surface, cost)
    left = len(surface.start) // 3
    for rules in (strict, strict._replace(least_cosine=-1.0, least_height=1e-6)):
        if left > target:
            fill_heap(surface, state, rules)
        done = 1
        while left > target and done:
            done = contract_edges(surface, state, rules, left - target, _CHUNK)
            left -= 2 * done
            if left > target and stop():
                return SimplifiedMesh(*_remaining(surface), "stopped")
    return SimplifiedMesh(*_remaining(surface), "no edge can be contracted" if left > target else "")


def _rules(surface: HalfEdgeSurface, cost: Cost) -> ContractionRules:
    size = float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    rounding = 16.0 * np.finfo(np.float64).eps * float(np.abs(surface.points).max())
    return ContractionRules(
        by_volume=cost == "volume",
        margin=_MARGIN * size + rounding,
        stiffness=1e-5,
        least_cosine=0.1,
        least_height=1e-4,
    )


def _start(surface: HalfEdgeSurface, max_error: float) -> ContractionState:
    halves, around = len(surface.start), _MOST_AROUND
    heap = EdgeHeap(
        np.empty(halves),
        np.full(halves, -1, np.int32),
        np.empty(halves // 2, np.int32),
        np.zeros(1, np.int32),
    )
    patch = EdgePatch(
        triangles=np.empty(around, np.int32),
        ring=np.empty(around, np.int32),
        normals=np.empty((around, 3)),
        offsets=np.empty(around),
        weights=np.empty(around),
        margins=np.empty(around),
        rows=np.empty((around, 3)),
        sides=np.empty(around),
        place=np.empty(3),
        mark=np.zeros(len(surface.points), np.int64),
        clock=np.zeros(1, np.int64),
    )
    return ContractionState(
        heap,
        make_tree(surface),
        patch,
        _original(surface, max_error),
        found=np.empty(halves // 3, np.int32),
        stamp=np.zeros(halves // 3, np.int64),
        box=np.empty((2, 3)),
    )


def _original(surface: HalfEdgeSurface, max_error: float) -> OriginalSurface:
    """Return a copy of the surface from which the distance is bounded; without a limit, a single triangle."""
    limited = max_error < _UNBOUNDED
    kept = surface.start if limited else surface.start[:3]
    copy = HalfEdgeSurface(surface.points.copy(), kept.copy(), kept, kept)
    limit, bound = max_error if limited else _UNBOUNDED, np.zeros(len(kept) // 3)
    return OriginalSurface(copy, make_tree(copy), limit, bound, np.empty((200, 9)), np.empty((2, 8, 3)))


def _remaining(surface: HalfEdgeSurface) -> MeshArrays:
    """Return the vertices and triangles that are left."""
    corners = surface.start.reshape(-1, 3)
    used, triangles = np.unique(corners[corners[:, 0] >= 0], return_inverse=True)
    return surface.points[used], triangles.reshape(-1, 3).astype(np.int64)
