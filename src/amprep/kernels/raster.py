"""Draws triangles into a depth buffer and shades the result: orthographic, on the processor alone."""

import numpy as np
from numba import njit

PLATE = 0
"""Kind of a triangle of the build plate: shaded with a millimetre grid."""
PART = 1
"""Kind of a triangle of a part: creases and outlines are drawn."""
SUPPORT = 2
"""Kind of a triangle of a support: outlines are drawn faintly."""


@njit(cache=True)
def draw(points, triangles, first, depth, ids):
    """Draw triangles where they are nearer than what is there.

    Parameters
    ----------
    points
        ``(n, 3)`` float64: column, row, depth; pixel (i, j) has its centre at column j, row i.
    triangles
        ``(m, 3)`` int32.
    first
        Triangle k is entered as ``first + k``.
    depth, ids
        ``(h, w)`` float32 and int32, modified in place; ids may be of shape (0, 0): then only depth is kept.
    """
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
        # barycentric weights of b and c and the depth are linear in column and row
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
                            ids[row, column] = first + k
                elif entered:
                    break  # a row meets a triangle in one run
                beta += beta_x
                gamma += gamma_x
                near += slope


@njit(cache=True)
def light_facets(vertices, triangles, axes, sun, pixels_per_mm, normals, facets):
    """Compute the normal of each triangle and how it takes the light on the side that the viewer sees.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` float64 mm, ``(m, 3)`` int32.
    axes
        ``(3, 3)`` float64, rows: right, down, away from the viewer.
    sun
        ``(3,)`` float64, unit vector along the light's way.
    normals
        ``(m, 3)`` float32, modified in place: unit normals, zero without area.
    facets
        ``(m, 4)`` float32, modified in place: share of direct light, share of ambient light, and how the
        depth grows in mm for a pixel to the right and down.
    """
    for k in range(triangles.shape[0]):
        a, b, c = vertices[triangles[k, 0]], vertices[triangles[k, 1]], vertices[triangles[k, 2]]
        x = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
        y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
        z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        length = np.sqrt(x * x + y * y + z * z)
        if length > 0.0:
            x, y, z = x / length, y / length, z / length
        normals[k, 0], normals[k, 1], normals[k, 2] = x, y, z
        if x * axes[2, 0] + y * axes[2, 1] + z * axes[2, 2] > 0.0:
            x, y, z = -x, -y, -z
        away = x * axes[2, 0] + y * axes[2, 1] + z * axes[2, 2]
        steep = min(away, -0.08) * pixels_per_mm
        facets[k, 0] = 0.68 * max(-(x * sun[0] + y * sun[1] + z * sun[2]), 0.0)
        facets[k, 1] = 0.34 + 0.20 * z - 0.10 * away
        facets[k, 2] = -(x * axes[0, 0] + y * axes[0, 1] + z * axes[0, 2]) / steep
        facets[k, 3] = -(x * axes[1, 0] + y * axes[1, 1] + z * axes[1, 2]) / steep


@njit(cache=True)
def lit_share(shadow, column, row, near, bias):
    """Return the share in [0, 1] of the four nearest shadow cells that do not lie nearer to the light."""
    height, width = shadow.shape
    j, i = int(np.floor(column)), int(np.floor(row))
    if i < 0 or j < 0 or i >= height - 1 or j >= width - 1:
        return 1.0
    u, v = column - j, row - i
    share = (1 - u) * (1 - v) * (near < shadow[i, j] + bias) + u * (1 - v) * (near < shadow[i, j + 1] + bias)
    return (
        share + (1 - u) * v * (near < shadow[i + 1, j] + bias) + u * v * (near < shadow[i + 1, j + 1] + bias)
    )


@njit(cache=True)
def openness(depth, row, column, slope_x, slope_y, offsets, reach):
    """Return in [0, 1] how open the surface at a pixel lies: depths nearer than its tangent plane close it.

    `offsets` is ``(4, k, 2)`` int64: rows and columns to look at, one list for each pixel of a 2 x 2 block;
    what is nearer by more than `reach` mm counts less and less.
    """
    height, width = depth.shape
    here, closed, seen = depth[row, column], 0.0, 0
    own = offsets[2 * (row & 1) + (column & 1)]
    for k in range(own.shape[0]):
        i, j = row + own[k, 0], column + own[k, 1]
        if i < 0 or j < 0 or i >= height or j >= width:
            continue
        seen += 1
        rise = here + slope_y * own[k, 0] + slope_x * own[k, 1] - depth[i, j]
        if rise > 0.02 * reach:
            closed += min(1.0, rise / (0.35 * reach)) * min(1.0, reach / rise)
    return 1.0 - closed / max(seen, 1)


@njit(cache=True)
def outline(ids, depth, row, column, slope_x, slope_y, owner, normals, jump):
    """Return 2 where another body or a step in depth adjoins, 1 at a crease of the same body, 0 elsewhere."""
    height, width = depth.shape
    here, found = ids[row, column], 0
    for i, j, step in ((0, 1, slope_x), (0, -1, -slope_x), (1, 0, slope_y), (-1, 0, -slope_y)):
        if row + i < 0 or column + j < 0 or row + i >= height or column + j >= width:
            continue
        there = ids[row + i, column + j]
        if there == here:
            continue
        behind = depth[row + i, column + j] - depth[row, column] - step
        if there < 0 or (owner[there] != owner[here] and behind > 0.0) or behind > jump:
            return 2
        dot = 0.0
        for axis in range(3):
            dot += normals[here, axis] * normals[there, axis]
        if owner[there] == owner[here] and abs(dot) < 0.86 and abs(behind) < jump:
            found = 1
    return found


@njit(cache=True)
def plate_tone(x, y, size_x, size_y, is_round, pixel):
    """Return the tone of the plate at x, y mm: edge, lines each 10 and 50 mm; negative outside."""
    if is_round:
        off = size_x / 2 - np.sqrt((x - size_x / 2) ** 2 + (y - size_y / 2) ** 2)
    else:
        off = min(x, size_x - x, y, size_y - y)
    if off < 0.0:
        return -1.0
    if off < 3.0 * pixel:
        return 0.35
    to_ten = min(abs(x - 10.0 * np.round(x / 10.0)), abs(y - 10.0 * np.round(y / 10.0)))
    to_fifty = min(abs(x - 50.0 * np.round(x / 50.0)), abs(y - 50.0 * np.round(y / 50.0)))
    if to_fifty < 1.0 * pixel:
        return 0.60
    return 0.82 if to_ten < 0.7 * pixel else 1.0


@njit(cache=True)
def shade(
    ids, depth, mark_ids, mark_depth, shadow, to_world, to_light, facets, normals, kinds, owner, colours,
    mark_colours, offsets, plate, background, image,
):  # fmt: skip
    """Shade every pixel of the buffers and average blocks of 2 x 2 into the picture.

    Parameters
    ----------
    ids, depth
        ``(2h, 2w)`` int32 triangle or -1, float32 depth in mm.
    mark_ids, mark_depth
        The same for marks, which shine through what hides them.
    shadow
        ``(s, s)`` float32 depth seen from the light.
    to_world, to_light
        ``(3, 4)`` float64: (column, row, depth) to build coordinates, and to the shadow's column, row, depth.
    normals, facets
        Per triangle, see `light_facets`.
    kinds, owner, colours
        Per triangle: uint8 kind, int32 body, ``(m, 3)`` float32 linear colour.
    mark_colours
        ``(k, 3)`` float32 linear colour per triangle of the marks, shaded already.
    offsets
        See `openness`.
    plate
        Size x, size y, 1 for a round one, mm a pixel, reach of the openness in mm, bias of the shadow in mm.
    background
        ``(h, 3)`` float32 linear colour of each row.
    image
        ``(h, w, 3)`` float32 linear colour, zeros, modified in place.
    """
    pixel, reach, bias = plate[3], plate[4], plate[5]
    at, lit = np.zeros(3), np.zeros(3)
    for row in range(ids.shape[0]):
        for column in range(ids.shape[1]):
            here, near, tone = ids[row, column], depth[row, column], 1.0
            if here >= 0:
                for axis in range(3):
                    at[axis] = to_world[axis, 0] * column + to_world[axis, 1] * row + to_world[axis, 3]
                    at[axis] += to_world[axis, 2] * near
                    lit[axis] = to_light[axis, 0] * column + to_light[axis, 1] * row + to_light[axis, 3]
                    lit[axis] += to_light[axis, 2] * near
                slope_x, slope_y = facets[here, 2], facets[here, 3]
                share = openness(depth, row, column, slope_x, slope_y, offsets, reach)
                sun = facets[here, 0]
                if sun > 0.0:
                    sun *= lit_share(shadow, lit[0], lit[1], lit[2], bias)
                tone = facets[here, 1] * share * share + sun * (0.35 + 0.65 * share)
                if kinds[here] == PLATE:
                    pattern = plate_tone(at[0], at[1], plate[0], plate[1], plate[2] > 0.0, pixel)
                    tone *= pattern
                    if pattern < 0.0:
                        here = -1
                else:
                    line = outline(ids, depth, row, column, slope_x, slope_y, owner, normals, 1.5 + 4 * pixel)
                    if kinds[here] == PART:
                        tone *= 0.32 if line == 2 else (0.62 if line == 1 else 1.0)
                    elif line == 2:
                        tone *= 0.7
            mark = mark_ids[row, column]
            over = 0.0 if mark < 0 else (0.40 if mark_depth[row, column] > near + 0.5 else 0.95)
            for channel in range(3):
                value = colours[here, channel] * tone if here >= 0 else background[row // 2, channel]
                if over > 0.0:
                    value += over * (mark_colours[mark, channel] - value)
                image[row // 2, column // 2, channel] += 0.25 * value
