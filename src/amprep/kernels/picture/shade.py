"""Shade the pixels of a depth buffer: sunlight with shadows, openness, outlines, plate and marks.

Strategy: the scene is drawn at twice the picture's width and height, and each pixel is visited once. Its light has
three factors: the angle of the facet to the sun and to the viewer (computed once per triangle), the shadow (a second
depth buffer, seen from the sun), and the openness of the surface (the depth of 7 pixels around it, in 4 different
spirals for the 4 pixels of a block). Averaging blocks of 2 x 2 pixels smooths edges and the spirals' pattern. Time is
in proportion to the pixels of the picture.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Bytes, Float32s, Floats, Int32s, Int64s
from amprep.kernels.picture.rasterise import DepthBuffer

PLATE = 0
"""Kind of a triangle of the build plate: shaded with a millimetre grid."""
PART = 1
"""Kind of a triangle of a part: creases and outlines are drawn."""
SUPPORT = 2
"""Kind of a triangle of a support: outlines are drawn faintly."""

_SUN = 0.68
"""Brightness of direct light."""
_AMBIENT, _FROM_ABOVE, _FROM_VIEWER = 0.34, 0.20, 0.10
"""Brightness of ambient light, and its change for facets that face upwards or the viewer."""
_GRAZING = -0.08
"""Limit of a facet's slope towards the viewer, beyond which its depth per pixel is not computed."""
_CREASE = 0.86
"""Cosine of the angle between facets above which their common edge is not drawn."""
_FADED, _MARKED = 0.40, 0.95
"""Opacity of marks behind and before other surfaces."""


class Facets(NamedTuple):
    """Properties of each triangle of a scene.

    Attributes
    ----------
    normals
        ``(m, 3)`` float32 unit normals; zero for triangles without area.
    light
        ``(m, 4)`` float32: direct light, ambient light, and the increase of depth in mm for one pixel to the
        right and for one pixel down.
    kinds
        ``(m,)`` `PLATE`, `PART` or `SUPPORT`.
    owner
        ``(m,)`` index of the mesh.
    colours
        ``(m, 3)`` float32 linear colour.
    """

    normals: Float32s
    light: Float32s
    kinds: Bytes
    owner: Int32s
    colours: Float32s


class DrawnMarks(NamedTuple):
    """Marks over the scene: their buffer, and the shaded linear colour ``(k, 3)`` of each triangle."""

    buffer: DepthBuffer
    colours: Float32s


class Sun(NamedTuple):
    """The shadow map.

    Attributes
    ----------
    depth
        ``(s, s)`` float32 depth seen from the sun.
    from_pixel
        ``(3, 4)`` map of the picture's column, row and depth to the shadow map's.
    bias
        Difference of depth in mm that still counts as lit.
    """

    depth: Float32s
    from_pixel: Floats
    bias: float


class Openness(NamedTuple):
    """Parameters of `openness_at`.

    Attributes
    ----------
    offsets
        ``(4, k, 2)`` rows and columns to look at, for each pixel of a 2 x 2 block.
    reach
        Difference of depth in mm beyond which a nearer surface counts less and less.
    """

    offsets: Int64s
    reach: float


class PlateShape(NamedTuple):
    """The build plate: its sizes in mm, whether it is round, and the size of a pixel in mm."""

    size_x: float
    size_y: float
    is_round: bool
    pixel: float


@njit(cache=True)
def light_facets(
    vertices: Floats, triangles: Int32s, axes: Floats, sun: Floats, pixels_per_mm: float, facets: Facets
) -> None:
    """Compute the normal of each triangle and the light on the side that the viewer sees.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)``.
    axes
        ``(3, 3)``, rows: right, down, away from the viewer.
    sun
        ``(3,)`` unit vector in the direction of the light.
    pixels_per_mm
        Scale of the picture.
    facets
        Normals and light are modified in place.
    """
    normals, light = facets.normals, facets.light
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
        steep = min(away, _GRAZING) * pixels_per_mm
        light[k, 0] = _SUN * max(-(x * sun[0] + y * sun[1] + z * sun[2]), 0.0)
        light[k, 1] = _AMBIENT + _FROM_ABOVE * z - _FROM_VIEWER * away
        light[k, 2] = -(x * axes[0, 0] + y * axes[0, 1] + z * axes[0, 2]) / steep
        light[k, 3] = -(x * axes[1, 0] + y * axes[1, 1] + z * axes[1, 2]) / steep


@njit(cache=True)
def lit_fraction(shadow: Float32s, column: float, row: float, near: float, bias: float) -> float:
    """Return the fraction of sunlight at a point: the weight of those of the four nearest pixels that do not shade it.

    Parameters
    ----------
    shadow
        ``(s, s)`` depth in mm seen from the sun.
    column, row, near
        The point in the shadow map.
    bias
        Difference of depth in mm that still counts as lit.
    """
    height, width = shadow.shape
    j, i = int(np.floor(column)), int(np.floor(row))
    if i < 0 or j < 0 or i >= height - 1 or j >= width - 1:
        return 1.0
    u, v = column - j, row - i
    above = (1 - u) * (1 - v) * (near < shadow[i, j] + bias) + u * (1 - v) * (near < shadow[i, j + 1] + bias)
    return float(
        above + (1 - u) * v * (near < shadow[i + 1, j] + bias) + u * v * (near < shadow[i + 1, j + 1] + bias)
    )


@njit(cache=True)
def openness_at(
    depth: Float32s, row: int, column: int, slope_x: float, slope_y: float, openness: Openness
) -> float:
    """Return in [0, 1] how open the surface at a pixel is; surfaces nearer than its tangent plane close it.

    Parameters
    ----------
    depth
        ``(h, w)`` mm.
    row, column
        The pixel.
    slope_x, slope_y
        Increase of depth in mm for one pixel to the right and for one pixel down.
    openness
        Pixels to look at, and reach.
    """
    height, width = depth.shape
    here, closed, seen = depth[row, column], 0.0, 0
    spiral, offsets, reach = 2 * (row & 1) + (column & 1), openness.offsets, openness.reach
    for k in range(offsets.shape[1]):
        down, right = offsets[spiral, k, 0], offsets[spiral, k, 1]
        i, j = row + down, column + right
        if i < 0 or j < 0 or i >= height or j >= width:
            continue
        seen += 1
        rise = here + slope_y * down + slope_x * right - depth[i, j]
        if rise > 0.02 * reach:
            closed += min(1.0, rise / (0.35 * reach)) * min(1.0, reach / rise)
    return 1.0 - closed / max(seen, 1)


@njit(cache=True)
def outline_at(
    buffer: DepthBuffer, row: int, column: int, slope_x: float, slope_y: float, facets: Facets, jump: float
) -> int:
    """Return 2 at an outline, 1 at a crease, and 0 elsewhere.

    An outline is the border to the background, to another mesh behind this one, or to a surface that is more than
    `jump` mm behind. A crease is the border between facets of the same mesh at different angles.

    Parameters
    ----------
    buffer
        The scene.
    row, column
        A pixel with a triangle.
    slope_x, slope_y
        Increase of depth in mm for one pixel to the right and for one pixel down.
    facets
        Facets of the scene's triangles.
    jump
        Smallest difference in depth (mm) that is an outline.
    """
    ids, depth = buffer.ids, buffer.depth
    height, width = depth.shape
    here, found = ids[row, column], 0
    for i, j, step in ((0, 1, slope_x), (0, -1, -slope_x), (1, 0, slope_y), (-1, 0, -slope_y)):
        if row + i < 0 or column + j < 0 or row + i >= height or column + j >= width:
            continue
        there = ids[row + i, column + j]
        if there == here:
            continue
        behind = depth[row + i, column + j] - depth[row, column] - step
        if there < 0 or (facets.owner[there] != facets.owner[here] and behind > 0.0) or behind > jump:
            return 2
        dot = 0.0
        for axis in range(3):
            dot += facets.normals[here, axis] * facets.normals[there, axis]
        if facets.owner[there] == facets.owner[here] and abs(dot) < _CREASE and abs(behind) < jump:
            found = 1
    return found


@njit(inline="always")
def _to_multiple(value: float, step: float) -> float:
    """Return the distance of a value from the nearest multiple of a step."""
    return abs(value - step * np.floor(value / step + 0.5))


@njit(cache=True)
def plate_tone(x: float, y: float, plate: PlateShape) -> float:
    """Return the tone of the plate at a point: 1, darker on its edge and on lines every 10 and 50 mm; negative outside.

    Parameters
    ----------
    x, y
        The point, mm.
    plate
        Its shape and the size of a pixel.
    """
    pixel = plate.pixel
    if plate.is_round:
        inside = plate.size_x / 2 - np.sqrt((x - plate.size_x / 2) ** 2 + (y - plate.size_y / 2) ** 2)
    else:
        inside = min(x, plate.size_x - x, y, plate.size_y - y)
    if inside < 0.0:
        return -1.0
    if inside < 3.0 * pixel:
        return 0.35
    if min(_to_multiple(x, 50.0), _to_multiple(y, 50.0)) < 1.0 * pixel:
        return 0.60
    return 0.82 if min(_to_multiple(x, 10.0), _to_multiple(y, 10.0)) < 0.7 * pixel else 1.0


@njit(inline="always")
def _mapped(matrix: Floats, axis: int, column: int, row: int, near: float) -> float:
    """Return one coordinate of a pixel and its depth under a ``(3, 4)`` map."""
    return float(matrix[axis, 0] * column + matrix[axis, 1] * row + matrix[axis, 3] + matrix[axis, 2] * near)


@njit(cache=True)
def shade(
    buffer: DepthBuffer,
    marks: DrawnMarks,
    facets: Facets,
    to_world: Floats,
    sun: Sun,
    openness: Openness,
    plate: PlateShape,
    background: Float32s,
    image: Float32s,
) -> None:
    """Shade every pixel of the buffers and average blocks of 2 x 2 pixels into the picture.

    Parameters
    ----------
    buffer
        ``(2h, 2w)``, the scene.
    marks
        ``(2h, 2w)``; they are faintly visible behind other surfaces.
    facets
        Facets of the scene's triangles.
    to_world
        ``(3, 4)`` map of column, row and depth to build coordinates.
    sun, openness, plate
        Shadow, ambient occlusion, and the build plate.
    background
        ``(h, 3)`` linear colour of each row.
    image
        ``(h, w, 3)`` linear colour, zeros, modified in place.
    """
    ids, depth = buffer.ids, buffer.depth
    jump = 1.5 + 4 * plate.pixel
    for row in range(ids.shape[0]):
        for column in range(ids.shape[1]):
            here, near, tone = ids[row, column], depth[row, column], 1.0
            if here >= 0:
                slope_x, slope_y = facets.light[here, 2], facets.light[here, 3]
                opened = openness_at(depth, row, column, slope_x, slope_y, openness)
                direct = facets.light[here, 0]
                if direct > 0.0:
                    sun_column = _mapped(sun.from_pixel, 0, column, row, near)
                    sun_row = _mapped(sun.from_pixel, 1, column, row, near)
                    sun_depth = _mapped(sun.from_pixel, 2, column, row, near)
                    direct *= lit_fraction(sun.depth, sun_column, sun_row, sun_depth, sun.bias)
                tone = facets.light[here, 1] * opened * opened + direct * (0.35 + 0.65 * opened)
                if facets.kinds[here] == PLATE:
                    x = _mapped(to_world, 0, column, row, near)
                    y = _mapped(to_world, 1, column, row, near)
                    pattern = plate_tone(x, y, plate)
                    tone *= pattern
                    if pattern < 0.0:
                        here = -1
                else:
                    line = outline_at(buffer, row, column, slope_x, slope_y, facets, jump)
                    if facets.kinds[here] == PART:
                        tone *= 0.32 if line == 2 else (0.62 if line == 1 else 1.0)
                    elif line == 2:
                        tone *= 0.7
            mark = marks.buffer.ids[row, column]
            hidden = marks.buffer.depth[row, column] > near + 0.5
            opacity = 0.0 if mark < 0 else (_FADED if hidden else _MARKED)
            for channel in range(3):
                value = facets.colours[here, channel] * tone if here >= 0 else background[row // 2, channel]
                if opacity > 0.0:
                    value += opacity * (marks.colours[mark, channel] - value)
                image[row // 2, column // 2, channel] += 0.25 * value
