"""Connected components of the vertices of a mesh, by disjoint sets with path halving."""

from amprep.arrays import Int64s
from amprep.kernels.helper import kernel, uncounted


@uncounted
def root_of(parent: Int64s, member: int) -> int:
    """Return the root of the set of a member; the way to it becomes shorter."""
    while parent[member] != member:
        parent[member] = parent[parent[member]]
        member = parent[member]
    return member


@kernel
def join_corners(triangles: Int64s, parent: Int64s) -> None:
    """Join the vertices of each triangle.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    parent
        ``(n,)`` the number of each vertex; then the least number in its component.
    """
    for t in range(len(triangles)):
        a = root_of(parent, triangles[t, 0])
        for corner in range(1, 3):
            b = root_of(parent, triangles[t, corner])
            parent[max(a, b)] = min(a, b)
            a = min(a, b)
    for vertex in range(len(parent)):
        parent[vertex] = root_of(parent, vertex)
