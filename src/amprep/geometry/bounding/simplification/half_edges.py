"""Half-edges of closed triangle meshes."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface


def make_half_edges(vertices: Floats, triangles: Int64s) -> HalfEdgeSurface:
    """Return the half-edges of a closed oriented mesh.

    Where more than two triangles meet at an edge they are paired, and vertices at which several surfaces touch become
    several vertices in the same place, so that the surface is a manifold.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``; every edge is traversed equally often in both directions.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    start = np.ascontiguousarray(triangles, np.int64).ravel()
    end = np.roll(np.asarray(triangles, np.int64), -1, axis=1).ravel()
    forward = np.argsort(start * len(vertices) + end, kind="stable")
    backward = np.argsort(end * len(vertices) + start, kind="stable")
    opposite = np.empty(len(start), np.int64)
    opposite[forward] = backward
    opposite[backward] = forward
    number = np.arange(len(start))
    previous = number - 1 + 3 * (number % 3 == 0)
    turned = opposite[previous]
    graph = coo_array((np.ones(len(start), np.int8), (number, turned)), shape=(len(start),) * 2)
    count, label = connected_components(graph, directed=False)
    points, leaving = np.empty((count, 3)), np.empty(count, np.int32)
    points[label], leaving[label] = vertices[start], number
    return HalfEdgeSurface(points, label.astype(np.int32), opposite.astype(np.int32), leaving)
