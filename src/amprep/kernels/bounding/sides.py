"""Connected components of a closed mesh on both sides of a plane."""

from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper


@helper
def _root(parent, i):
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def label_sides(
    vertices: Floats, edges: Int64s, height: Floats, label: Int64s, section: Floats, owner: Int64s
) -> int:
    """Label the components of a mesh on each side of a plane, and compute where edges cross the plane.

    A vertex in the plane is above it.

    Parameters
    ----------
    vertices, edges
        ``(n, 3)`` mm and ``(e, 2)``.
    height
        ``(n,)`` signed distance of the vertices to the plane.
    label
        ``(n,)``, modified in place: the least vertex of the component of each vertex.
    section, owner
        ``(2 e, 3)`` and ``(2 e,)``, modified in place: points of the plane, and for each the label of a component
        that it bounds.

    Returns
    -------
    count
        Number of rows of `section` and `owner`.
    """
    for i in range(label.shape[0]):
        label[i] = i
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        if (height[i] < 0.0) == (height[j] < 0.0):
            p, q = _root(label, i), _root(label, j)
            label[max(p, q)] = min(p, q)
    for i in range(label.shape[0]):
        label[i] = _root(label, i)
    count = 0
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        if (height[i] < 0.0) != (height[j] < 0.0):
            t = height[i] / (height[i] - height[j])
            for c in range(3):
                section[count, c] = vertices[i, c] + t * (vertices[j, c] - vertices[i, c])
                section[count + 1, c] = section[count, c]
            owner[count], owner[count + 1] = label[i], label[j]
            count += 2
    return count
