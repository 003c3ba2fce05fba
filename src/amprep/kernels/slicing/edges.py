"""Find the neighbours of triangles.

Half-edge ``3 t + c`` leads from corner c of triangle t to the next corner. Two counting sorts bring the half-edges of
an edge together, in linear time.
"""

from amprep.arrays import Int64s
from amprep.kernels.helper import kernel


@kernel
def order_edges(triangles: Int64s, begins: Int64s, spare: Int64s, order: Int64s) -> None:
    """Sort half-edges by their lower vertex, then by their higher one.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    begins
        ``(v + 1,)`` work array.
    spare, order
        ``(3 m,)`` work array, and the half-edges in order; filled.
    """
    corners = triangles.size
    for turn in range(2):
        begins[:] = 0
        for half in range(corners):
            a, b = triangles[half // 3, half % 3], triangles[half // 3, (half + 1) % 3]
            begins[(max(a, b) if turn == 0 else min(a, b)) + 1] += 1
        for vertex in range(len(begins) - 1):
            begins[vertex + 1] += begins[vertex]
        for i in range(corners):
            half = i if turn == 0 else spare[i]
            a, b = triangles[half // 3, half % 3], triangles[half // 3, (half + 1) % 3]
            vertex = max(a, b) if turn == 0 else min(a, b)
            if turn == 0:
                spare[begins[vertex]] = half
            else:
                order[begins[vertex]] = half
            begins[vertex] += 1


@kernel
def pair_edges(triangles: Int64s, order: Int64s, twin: Int64s) -> int:
    """Find the twin of each half-edge at edges of two triangles: -1 at open edges, -2 where more triangles meet.

    Returns
    -------
    nonmanifold
        Number of half-edges at edges of more than two triangles.
    """
    nonmanifold = 0
    at = 0
    while at < len(order):
        half = order[at]
        a, b = triangles[half // 3, half % 3], triangles[half // 3, (half + 1) % 3]
        low, high = min(a, b), max(a, b)
        end = at + 1
        while end < len(order):
            other = order[end]
            a, b = triangles[other // 3, other % 3], triangles[other // 3, (other + 1) % 3]
            if min(a, b) != low or max(a, b) != high:
                break
            end += 1
        if end - at == 2:
            twin[half], twin[order[at + 1]] = order[at + 1], half
        else:
            for i in range(at, end):
                twin[order[i]] = -1 if end - at == 1 else -2
            nonmanifold += end - at if end - at > 2 else 0
        at = end
    return nonmanifold
