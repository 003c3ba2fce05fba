"""Draw triangles into a depth buffer: orthographic, without a graphics card.

Strategy: triangles are drawn one after the other, and each pixel keeps the nearest one. The barycentric weights and
the depth of a triangle are linear in column and row, so that a pixel costs three additions. Time is in proportion to
the pixels covered.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Float32s, Floats, Int32s


class DepthBuffer(NamedTuple):
    """Nearest surface of each pixel.

    Attributes
    ----------
    depth
        ``(h, w)`` float32 mm, infinite where nothing is drawn.
    ids
        ``(h, w)`` int32 index of the triangle or -1; of shape (0, 0) to keep the depth only.
    """

    depth: Float32s
    ids: Int32s


@njit(cache=True)
def draw(points: Floats, triangles: Int32s, buffer: DepthBuffer) -> None:
    """Draw triangles where they are nearer than the buffer's surface.

    Parameters
    ----------
    points
        ``(n, 3)`` column, row and depth; pixel (i, j) has its centre at column j and row i.
    triangles
        ``(m, 3)``.
    buffer
        Modified in place.
    """
    depth, ids = buffer.depth, buffer.ids
    height, width = depth.shape
    keep = ids.shape[0] > 0
    for k in range(triangles.shape[0]):
        a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        xa, ya, za = points[a, 0], points[a, 1], points[a, 2]
        xb, yb, zb = points[b, 0], points[b, 1], points[b, 2]
        xc, yc, zc = points[c, 0], points[c, 1], points[c, 2]
        area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
        if area == 0.0:
            continue
        top = max(0, int(np.ceil(min(ya, yb, yc))))
        bottom = min(height - 1, int(np.floor(max(ya, yb, yc))))
        left = max(0, int(np.ceil(min(xa, xb, xc))))
        right = min(width - 1, int(np.floor(max(xa, xb, xc))))
        if top > bottom or left > right:
            continue
        # The barycentric weights of b and c and the depth are linear in column and row.
        beta_x, beta_y = (yc - ya) / area, (xa - xc) / area
        gamma_x, gamma_y = (ya - yb) / area, (xb - xa) / area
        slope = beta_x * (zb - za) + gamma_x * (zc - za)
        for row in range(top, bottom + 1):
            beta = beta_x * (left - xa) + beta_y * (row - ya)
            gamma = gamma_x * (left - xa) + gamma_y * (row - ya)
            near = za + beta * (zb - za) + gamma * (zc - za)
            entered = False
            for column in range(left, right + 1):
                if beta >= 0.0 and gamma >= 0.0 and beta + gamma <= 1.0:
                    entered = True
                    if near < depth[row, column]:
                        depth[row, column] = near
                        if keep:
                            ids[row, column] = k
                elif entered:
                    break  # the pixels of a triangle in a row are consecutive
                beta += beta_x
                gamma += gamma_x
                near += slope
