"""Round beams with spherical ends as arrays: balls along them, penetration into meshes, connection to the plate."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.shells import label_shells

_AXES = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
DIRECTIONS: Floats = _AXES[np.abs(_AXES).any(axis=1)] / np.linalg.norm(
    _AXES[np.abs(_AXES).any(axis=1)], axis=1, keepdims=True
)
"""``(26, 3)`` unit vectors; every direction is within 28 degrees of one of them."""


def sphere(count: int) -> Floats:
    """Return points distributed evenly on the unit sphere, ``(count, 3)``, by the golden angle."""
    z = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    angle = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    flat = np.sqrt(1.0 - z * z)
    return np.column_stack([flat * np.cos(angle), flat * np.sin(angle), z])


_SHELLS = (0.25, 0.5, 0.95)
"""Radii of the test points inside a ball, as fractions of its radius: it may touch a plate thinner than itself."""

_GRID, _MOST_CELLS = 128, 4_000_000
"""Number of cells along the longest side of the grid that marks the surroundings of surfaces, and the greatest number
of cells marked at once."""


class BeamSamples(NamedTuple):
    """Balls along beams, from end to end.

    Attributes
    ----------
    centres, radii
        ``(k, 3)`` and ``(k,)`` mm.
    strut
        ``(k,)`` strut of each ball.
    fraction
        ``(k,)`` position along the strut, 0 to 1.
    """

    centres: Floats
    radii: Floats
    strut: Ints
    fraction: Floats


def sample(nodes: Floats, struts: Ints, radii: Floats, step: float = 0.5) -> BeamSamples:
    """Return balls along beams, sorted by strut and position.

    Parameters
    ----------
    nodes, struts, radii
        ``(n, 3)`` mm, ``(m, 2)`` indices of nodes, ``(m, 2)`` mm at both ends.
    step
        Largest distance between two balls, in radii of the thinner end.
    """
    start, end = nodes[struts[:, 0]], nodes[struts[:, 1]]
    length = np.linalg.norm(end - start, axis=1)
    count = np.ceil(length / (step * radii.min(axis=1, initial=np.inf))).astype(np.int64) + 1
    strut = np.repeat(np.arange(len(struts)), count)
    place = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    fraction = place / np.maximum(count - 1, 1)[strut]
    centres = start[strut] + fraction[:, None] * (end - start)[strut]
    radius = radii[strut, 0] + fraction * (radii[strut, 1] - radii[strut, 0])
    return BeamSamples(centres, radius, strut, fraction)


def too_deep(points: Floats, vertices: Floats, triangles: Ints, depth: float) -> Bools:
    """Tell which points are in a closed mesh together with the point `depth` below them.

    Parameters
    ----------
    points
        ``(k, 3)`` mm.
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    depth
        Permitted depth, mm.
    """
    found = inside(points, vertices, triangles)
    within = np.flatnonzero(found)
    found[within] = inside(points[within] - (0.0, 0.0, depth), vertices, triangles)
    return found


def balls_too_deep(
    centres: Floats, reach: Floats, vertices: Floats, triangles: Ints, depth: float, directions: Floats
) -> Bools:
    """Tell which balls have their centre, or a point at distance `reach` from it, too deep in a closed mesh.

    Parameters
    ----------
    centres, reach
        ``(k, 3)`` and ``(k,)`` mm.
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    depth
        Permitted depth, mm, measured vertically as in `too_deep`.
    directions
        ``(d, 3)`` unit vectors from the centre to the tested points.
    """
    found = too_deep(centres, vertices, triangles, depth)
    near = np.flatnonzero(near_surface(centres, float(reach.max(initial=0.0)), vertices, triangles) & ~found)
    for direction in directions:
        near = near[~found[near]]
        points = centres[near] + reach[near, None] * direction
        found[near] = too_deep(points, vertices, triangles, depth)
    return found


def near_surface(points: Floats, reach: float, vertices: Floats, triangles: Ints) -> Bools:
    """Tell which points may have a triangle within `reach`; all other points have none.

    Parameters
    ----------
    points
        ``(k, 3)`` mm.
    reach
        Distance, mm.
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    """
    near = np.zeros(len(points), np.bool_)
    if not len(triangles) or not len(points):
        return near
    corners = vertices[triangles]
    low, high = corners.min(axis=1) - reach, corners.max(axis=1) + reach
    origin, extent = low.min(axis=0), high.max(axis=0) - low.min(axis=0)
    side = max(2.0 * reach, float(extent.max()) / _GRID, 1e-6)
    shape = np.floor(extent / side).astype(np.int64) + 1
    first, last = (np.floor((each - origin) / side).astype(np.int64) for each in (low, high))
    taken = np.zeros(int(shape.prod()), np.bool_)
    spans = last - first + 1
    for some in np.array_split(np.arange(len(triangles)), 1 + int(spans.prod(axis=1).sum()) // _MOST_CELLS):
        sizes = spans[some].prod(axis=1)
        owner = np.repeat(some, sizes)
        place = np.arange(len(owner)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        x, rest = place % spans[owner, 0], place // spans[owner, 0]
        cell = first[owner] + np.column_stack([x, rest % spans[owner, 1], rest // spans[owner, 1]])
        taken[np.ravel_multi_index(tuple(cell.T), tuple(shape))] = True
    within = ((points >= origin) & (points <= origin + extent)).all(axis=1)
    cell = np.minimum(np.floor((points[within] - origin) / side).astype(np.int64), shape - 1)
    near[within] = taken[np.ravel_multi_index(tuple(cell.T), tuple(shape))]
    return near


class GroundedBeams(NamedTuple):
    """Beams and solids that are connected to the plate.

    Attributes
    ----------
    struts, triangles
        ``(m,)`` and ``(t,)`` whether each strut, and each triangle of a solid, is connected to the plate.
    floating
        Number of components that are not.
    """

    struts: Bools
    triangles: Bools
    floating: int


def find_grounded(
    nodes: Floats,
    struts: Ints,
    radii: Floats,
    points: Floats,
    triangles: Ints,
    rests: Callable[[Floats], Bools],
) -> GroundedBeams:
    """Find the beams and solids that are connected to the plate, directly or through one another.

    The connected components of a graph with a vertex for every node, every piece of the solids, and the plate.

    Parameters
    ----------
    nodes, struts, radii
        Beams: ``(n, 3)`` mm, ``(m, 2)`` indices of nodes, ``(m, 2)`` mm at both ends.
    points, triangles
        Closed solids of any number of pieces, ``(p, 3)`` mm and ``(t, 3)``.
    rests
        Function that tells which vertices of the solids rest on the plate or on a part, ``(p,)``.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    radius = np.zeros(len(nodes))
    np.maximum.at(radius, struts.ravel(), radii.ravel())
    used = np.flatnonzero(radius > 0.0)
    pieces, piece = label_shells(triangles, len(points)) if len(triangles) else (0, np.empty(0, np.int64))
    plate = len(nodes) + pieces
    low = used[nodes[used, 2] <= 0.5 * radius[used]]
    resting = np.unique(piece[rests(points)[triangles].any(axis=1)]) if pieces else np.empty(0, np.int64)
    touching = [_touches(nodes, radius, used, points, triangles[piece == each]) for each in range(pieces)]
    numbers = np.repeat(np.arange(pieces), [len(each) for each in touching])
    first = np.concatenate([struts[:, 0], low, len(nodes) + resting, *touching])
    second = np.concatenate([struts[:, 1], np.full(len(low) + len(resting), plate), len(nodes) + numbers])
    graph = coo_array((np.ones(len(first), np.int8), (first, second)), shape=(plate + 1, plate + 1))
    label = connected_components(graph, directed=False)[1]
    grounded = label == label[plate]
    every = np.concatenate([used, len(nodes) + np.arange(pieces)])
    floating = len(np.unique(label[every[~grounded[every]]]))
    return GroundedBeams(grounded[struts[:, 0]], grounded[len(nodes) + piece], floating)


def _touches(nodes: Floats, radius: Floats, used: Ints, points: Floats, triangles: Ints) -> Ints:
    """Return the nodes whose balls enter a piece of the solids."""
    local, corners = np.unique(triangles, return_inverse=True)
    own, reach = points[local], radius[used, None]
    near = used[
        ((nodes[used] + reach > own.min(axis=0)) & (nodes[used] - reach < own.max(axis=0))).all(axis=1)
    ]
    rings = np.vstack([np.zeros((1, 3)), *(fraction * DIRECTIONS for fraction in _SHELLS)])
    tried = nodes[near, None] + radius[near, None, None] * rings
    found = inside(tried.reshape(-1, 3), own, corners.reshape(-1, 3).astype(np.int64)).reshape(
        len(near), len(rings)
    )
    return np.asarray(near[found.any(axis=1)])
