"""Construction of OBB trees."""

import numpy as np

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.helper import inlined, kernel
from amprep.kernels.trees.records import AXES, CENTRE, HALF, RADIUS, Vector

# Strategy. The moments of a set of triangles are sums over its triangles: area, area times centroid, and the second
# moments of a uniform distribution on the surface. They are computed once per triangle, about the centre of the mesh,
# so the covariance of a node is a sum of ten numbers a triangle. Nodes are made top-down with an explicit stack; two
# children are neighbours in memory. A node owns an interval of the order of triangles, which its split rearranges.

MOMENTS = 10
"""Area, area times centroid (3), and second moments xx, xy, xz, yy, yz, zz."""


@kernel
def write_moments(corners: Floats, moments: Floats, normals: Floats) -> None:
    """Write the moments and unit normals of triangles.

    Parameters
    ----------
    corners
        ``(n, 9)`` mm, relative to a point near the middle of the mesh.
    moments, normals
        ``(n, 10)`` and ``(n, 3)``, written in place; the normal of a triangle without area is 0.
    """
    for t in range(corners.shape[0]):
        ax, ay, az = corners[t, 0], corners[t, 1], corners[t, 2]
        ux, uy, uz = corners[t, 3] - ax, corners[t, 4] - ay, corners[t, 5] - az
        vx, vy, vz = corners[t, 6] - ax, corners[t, 7] - ay, corners[t, 8] - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        length = np.sqrt(nx * nx + ny * ny + nz * nz)
        scale = 1.0 / length if length > 0.0 else 0.0
        normals[t, 0], normals[t, 1], normals[t, 2] = nx * scale, ny * scale, nz * scale
        area = 0.5 * length
        moments[t, 0] = area
        column = 4
        for j in range(3):
            sum_j = corners[t, j] + corners[t, 3 + j] + corners[t, 6 + j]
            moments[t, 1 + j] = area * sum_j / 3.0
            for k in range(j, 3):
                sum_k = corners[t, k] + corners[t, 3 + k] + corners[t, 6 + k]
                products = 0.0
                for corner in range(0, 9, 3):
                    products += corners[t, corner + j] * corners[t, corner + k]
                moments[t, column] = area * (sum_j * sum_k + products) / 12.0
                column += 1


@inlined
def _rotate(matrix: Floats, axes: Floats, p: int, q: int) -> None:
    """Make one off-diagonal entry of a symmetric matrix 0 by a Jacobi rotation; the rows of `axes` turn as well."""
    theta = (matrix[q, q] - matrix[p, p]) / (2.0 * matrix[p, q])
    t = (1.0 if theta >= 0.0 else -1.0) / (abs(theta) + np.sqrt(theta * theta + 1.0))
    c = 1.0 / np.sqrt(t * t + 1.0)
    s = t * c
    for k in range(3):
        at_p, at_q = matrix[k, p], matrix[k, q]
        matrix[k, p], matrix[k, q] = c * at_p - s * at_q, s * at_p + c * at_q
    for k in range(3):
        at_p, at_q = matrix[p, k], matrix[q, k]
        matrix[p, k], matrix[q, k] = c * at_p - s * at_q, s * at_p + c * at_q
        at_p, at_q = axes[p, k], axes[q, k]
        axes[p, k], axes[q, k] = c * at_p - s * at_q, s * at_p + c * at_q


@inlined
def _principal_axes(
    moments: Floats, order: Int64s, start: int, end: int, matrix: Floats, axes: Floats
) -> None:
    """Write the eigenvectors of the covariance of the surface of triangles to the rows of `axes`."""
    area = x = y = z = xx = xy = xz = yy = yz = zz = 0.0
    for i in range(start, end):
        t = order[i]
        area += moments[t, 0]
        x += moments[t, 1]
        y += moments[t, 2]
        z += moments[t, 3]
        xx += moments[t, 4]
        xy += moments[t, 5]
        xz += moments[t, 6]
        yy += moments[t, 7]
        yz += moments[t, 8]
        zz += moments[t, 9]
    for j in range(3):
        for k in range(3):
            axes[j, k] = 1.0 if j == k else 0.0
    if area <= 0.0:
        return
    x, y, z = x / area, y / area, z / area
    matrix[0, 0], matrix[1, 1], matrix[2, 2] = xx / area - x * x, yy / area - y * y, zz / area - z * z
    matrix[0, 1], matrix[0, 2], matrix[1, 2] = xy / area - x * y, xz / area - x * z, yz / area - y * z
    matrix[1, 0], matrix[2, 0], matrix[2, 1] = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    small = 1e-15 * (abs(matrix[0, 0]) + abs(matrix[1, 1]) + abs(matrix[2, 2]))
    for _ in range(12):
        if abs(matrix[0, 1]) + abs(matrix[0, 2]) + abs(matrix[1, 2]) <= small:
            break
        if abs(matrix[0, 1]) > 0.0:
            _rotate(matrix, axes, 0, 1)
        if abs(matrix[0, 2]) > 0.0:
            _rotate(matrix, axes, 0, 2)
        if abs(matrix[1, 2]) > 0.0:
            _rotate(matrix, axes, 1, 2)


@inlined
def _triangle_axes(corners: Floats, normals: Floats, t: int, axes: Floats) -> None:
    """Write the direction of the longest edge of a triangle, the one normal to it in the plane, and the normal."""
    longest, edge = -1.0, 0
    for i in range(3):
        square = 0.0
        for k in range(3):
            square += (corners[t, 3 * ((i + 1) % 3) + k] - corners[t, 3 * i + k]) ** 2
        if square > longest:
            longest, edge = square, i
    length = np.sqrt(longest)
    if length == 0.0 or (normals[t, 0] == 0.0 and normals[t, 1] == 0.0 and normals[t, 2] == 0.0):
        return
    for k in range(3):
        axes[0, k] = (corners[t, 3 * ((edge + 1) % 3) + k] - corners[t, 3 * edge + k]) / length
        axes[2, k] = normals[t, k]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        axes[1, k] = axes[2, i] * axes[0, j] - axes[2, j] * axes[0, i]


@inlined
def _write_box(
    corners: Floats, order: Int64s, start: int, end: int, axes: Floats, shift: Floats, node: Floats
) -> None:
    """Write the least box of triangles along given axes to a row of nodes; lengths grow by the rounding."""
    square = 0.0
    for k in range(3):
        node[CENTRE + k] = shift[k]
    for k in range(3):
        ax, ay, az = axes[k, 0], axes[k, 1], axes[k, 2]
        low, high = np.inf, -np.inf
        for i in range(start, end):
            t = order[i]
            for c in range(0, 9, 3):
                along = ax * corners[t, c] + ay * corners[t, c + 1] + az * corners[t, c + 2]
                low, high = min(low, along), max(high, along)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        half += 1e-14 * (abs(low) + abs(high))
        node[CENTRE] += middle * ax
        node[CENTRE + 1] += middle * ay
        node[CENTRE + 2] += middle * az
        node[HALF + k] = half
        node[AXES + 3 * k], node[AXES + 3 * k + 1], node[AXES + 3 * k + 2] = ax, ay, az
        square += half * half
    node[RADIUS] = np.sqrt(square)


@inlined
def _mean_along(corners: Floats, order: Int64s, start: int, end: int, axis: Vector) -> float:
    """Return the mean of the corners along an axis."""
    total = 0.0
    for i in range(start, end):
        t = order[i]
        for c in range(0, 9, 3):
            total += axis[0] * corners[t, c] + axis[1] * corners[t, c + 1] + axis[2] * corners[t, c + 2]
    return total / (3.0 * (end - start))


@inlined
def _partition(corners: Floats, order: Int64s, start: int, end: int, axis: Vector, mean: float) -> int:
    """Move triangles with centroids below `mean` to the front of the interval; return the first of the others."""
    i, j = start, end
    while i < j:
        t = order[i]
        along = 0.0
        for c in range(0, 9, 3):
            along += axis[0] * corners[t, c] + axis[1] * corners[t, c + 1] + axis[2] * corners[t, c + 2]
        if along < 3.0 * mean:
            i += 1
        else:
            j -= 1
            order[i], order[j] = order[j], t
    return i


@inlined
def _split(corners: Floats, order: Int64s, start: int, end: int, node: Floats) -> int:
    """Split triangles at their mean along the longest axis; else along the second, the third; else into halves."""
    first = 0
    for k in range(1, 3):
        if node[HALF + k] > node[HALF + first]:
            first = k
    second, third = (first + 1) % 3, (first + 2) % 3
    if node[HALF + third] > node[HALF + second]:
        second, third = third, second
    for k in (first, second, third):
        axis = (node[AXES + 3 * k], node[AXES + 3 * k + 1], node[AXES + 3 * k + 2])
        middle = _partition(corners, order, start, end, axis, _mean_along(corners, order, start, end, axis))
        if start < middle < end:
            return middle
    return (start + end) // 2


@kernel
def write_cones(link: Int32s, normals: Floats, cones: Floats) -> None:
    """Write a cone of directions that contains the normals of all triangles below each node.

    The axis of an inner node is the mean direction of its children's axes; the angle covers both of their cones.

    Parameters
    ----------
    link
        Of the tree.
    normals
        ``(n, 3)``, in the order of the leaves; triangles without area are ignored.
    cones
        ``(2 n - 1, 4)``: unit axis, and the sine of the half angle; 2 where it is a right angle or more. Written in
        place.
    """
    for i in range(link.shape[0] - 1, -1, -1):
        if link[i] < 0:
            t = -1 - link[i]
            cones[i, 0], cones[i, 1], cones[i, 2] = normals[t, 0], normals[t, 1], normals[t, 2]
            cones[i, 3] = (
                0.0 if normals[t, 0] != 0.0 or normals[t, 1] != 0.0 or normals[t, 2] != 0.0 else -1.0
            )
            continue
        left, right = link[i], link[i] + 1
        if cones[left, 3] < 0.0 or cones[right, 3] < 0.0:
            child = right if cones[left, 3] < 0.0 else left
            for k in range(4):
                cones[i, k] = cones[child, k]
            continue
        x, y, z = (
            cones[left, 0] + cones[right, 0],
            cones[left, 1] + cones[right, 1],
            cones[left, 2] + cones[right, 2],
        )
        length = np.sqrt(x * x + y * y + z * z)
        cones[i, 0], cones[i, 1], cones[i, 2], cones[i, 3] = 1.0, 0.0, 0.0, 2.0
        if length < 1e-3 or max(cones[left, 3], cones[right, 3]) > 1.0:
            continue
        x, y, z = x / length, y / length, z / length
        cosine = min(1.0, x * cones[left, 0] + y * cones[left, 1] + z * cones[left, 2])
        angle = np.arccos(cosine) + np.arcsin(max(cones[left, 3], cones[right, 3])) + 1e-7
        if angle < 0.5 * np.pi:
            cones[i, 0], cones[i, 1], cones[i, 2], cones[i, 3] = x, y, z, np.sin(angle)


@kernel
def build_tree(
    corners: Floats,
    moments: Floats,
    normals: Floats,
    shift: Floats,
    order: Int64s,
    nodes: Floats,
    link: Int32s,
    work: Int64s,
    frames: Floats,
) -> int:
    """Write the nodes of an OBB tree with one triangle a leaf, and return its depth.

    Parameters
    ----------
    corners, moments, normals
        The triangles relative to `shift`, and what `write_moments` wrote.
    shift
        ``(3,)`` mm.
    order
        ``(n,)``, the numbers 0 to n - 1; on return the triangles in the order of the leaves.
    nodes, link
        ``(2 n - 1, 16)`` and ``(2 n - 1,)``, written in place; see `ObbTree`.
    work, frames
        ``(n + 1, 4)`` and ``(2, 3, 3)``, work arrays: intervals of triangles that have no node yet,
        and matrices.
    """
    matrix, axes = frames[0], frames[1]
    work[0, 0], work[0, 1], work[0, 2], work[0, 3] = 0, corners.shape[0], 0, 0
    waiting, count, depth = 1, 1, 0
    while waiting > 0:
        waiting -= 1
        start, end, i, level = work[waiting, 0], work[waiting, 1], work[waiting, 2], work[waiting, 3]
        depth = max(depth, level)
        _principal_axes(moments, order, start, end, matrix, axes)
        if end - start == 1:
            _triangle_axes(corners, normals, order[start], axes)
        node = nodes[i]
        _write_box(corners, order, start, end, axes, shift, node)
        if end - start == 1:
            link[i] = -1 - start
        else:
            middle = _split(corners, order, start, end, node)
            work[waiting, 0], work[waiting, 1] = middle, end
            link[i] = count
            work[waiting, 2], work[waiting, 3] = count + 1, level + 1
            work[waiting + 1, 0], work[waiting + 1, 1] = start, middle
            work[waiting + 1, 2], work[waiting + 1, 3] = count, level + 1
            waiting, count = waiting + 2, count + 2
    return depth
