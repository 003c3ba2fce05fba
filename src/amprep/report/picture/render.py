"""Render coloured meshes to pixels: prepare the arrays for `amprep.kernels.picture`, and encode its result."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Bytes, Float32s, Floats, Int64s, Ints
from amprep.model import BuildVolume
from amprep.report.picture.camera import Camera, box_corners, fitted, view_axes
from amprep.report.picture.scene import ColouredMesh, TriangleScene, assemble, linear, unit_normals

if TYPE_CHECKING:
    from amprep.kernels.picture.rasterise import DepthBuffer
    from amprep.kernels.picture.shade import DrawnMarks, Facets, PlateShape, Sun

SUN_AXES = view_axes(-112.0, 56.0)
"""Axes of a camera that looks in the direction of the sunlight."""
SHADOW_PIXELS = 2048
GOLDEN_ANGLE = 2.399963
SKY, FLOOR = "#fdfdfe", "#e4e8ee"
"""Colours of the background at the top and at the bottom."""


def render(
    meshes: list[ColouredMesh],
    marks: Sequence[ColouredMesh],
    camera: Camera,
    size: tuple[int, int],
    space: BuildVolume | None,
) -> Bytes:
    """Return the picture, ``(height, width, 3)``.

    Parameters
    ----------
    meshes
        Everything that is shaded and casts shadows; the plate casts none.
    marks
        Drawn over everything else; faint behind other surfaces.
    camera
        Made for a picture of twice the width and height.
    size
        Width and height in pixels.
    space
        Gives the plate its size and shape; None without a plate.
    """
    from amprep.kernels.picture.shade import Openness, shade

    scene = assemble(meshes)
    reach = max(3.0, 60.0 / camera.pixels_per_mm)
    image = np.zeros((size[1], size[0], 3), np.float32)
    shade(
        _drawn(scene.vertices, scene.triangles, camera, size),
        _drawn_marks(marks, camera, size),
        _facets(scene, camera),
        camera.inverse,
        _sun(scene, camera),
        Openness(_spirals(reach * camera.pixels_per_mm), reach),
        _plate(space, camera),
        _background(size[1]),
        image,
    )
    return _encoded(image)


def _drawn(vertices: Floats, triangles: Ints, camera: Camera, size: tuple[int, int]) -> "DepthBuffer":
    from amprep.kernels.picture.rasterise import DepthBuffer, draw

    shape = (2 * size[1], 2 * size[0])
    buffer = DepthBuffer(np.full(shape, np.inf, np.float32), np.full(shape, -1, np.int32))
    draw(camera.project(vertices), triangles, buffer)
    return buffer


def _drawn_marks(marks: Sequence[ColouredMesh], camera: Camera, size: tuple[int, int]) -> "DrawnMarks":
    from amprep.kernels.picture.shade import DrawnMarks

    if not marks:
        buffer = _drawn(np.empty((0, 3)), np.empty((0, 3), np.int32), camera, size)
        return DrawnMarks(buffer, np.empty((0, 3), np.float32))
    scene = assemble(list(marks))
    buffer = _drawn(scene.vertices, scene.triangles, camera, size)
    seen = _seen(buffer, len(scene.triangles))
    facing = -unit_normals(scene.vertices, scene.triangles[seen]) @ camera.axes[2]
    tones = np.zeros((len(scene.triangles), 3), np.float32)
    tones[seen] = (0.5 + 0.5 * np.maximum(facing, 0.0))[:, None] * scene.colours[seen]
    return DrawnMarks(buffer, tones)


def _seen(buffer: "DepthBuffer", count: int) -> Bools:
    """Tell which of `count` triangles are the nearest ones at some pixel."""
    seen = np.zeros(count, np.bool_)
    seen[buffer.ids[buffer.ids >= 0]] = True
    return seen


def _sun(scene: TriangleScene, camera: Camera) -> "Sun":
    """Return the shadow map, and the map from the camera's column, row and depth to it."""
    from amprep.kernels.picture.rasterise import DepthBuffer, draw
    from amprep.kernels.picture.shade import PLATE, Sun

    casting = scene.triangles[scene.kinds != PLATE]
    corners = box_corners(scene.vertices.min(axis=0), scene.vertices.max(axis=0))
    view = fitted(SUN_AXES, corners, (SHADOW_PIXELS, SHADOW_PIXELS), margin=4.0)
    depth = np.full((SHADOW_PIXELS, SHADOW_PIXELS), np.inf, np.float32)
    draw(view.project(scene.vertices), casting, DepthBuffer(depth, np.empty((0, 0), np.int32)))
    from_pixel: Floats = view.matrix @ np.vstack([camera.inverse, [0.0, 0.0, 0.0, 1.0]])
    return Sun(depth, from_pixel, bias=0.3 + 2.0 / view.pixels_per_mm)


def _facets(scene: TriangleScene, camera: Camera) -> "Facets":
    from amprep.kernels.picture.shade import Facets, light_facets

    count = len(scene.triangles)
    facets = Facets(
        np.zeros((count, 3), np.float32),
        np.zeros((count, 4), np.float32),
        scene.kinds,
        scene.owner,
        scene.colours,
    )
    light_facets(scene.vertices, scene.triangles, camera.axes, SUN_AXES[2], camera.pixels_per_mm, facets)
    return facets


def _spirals(reach: float) -> Int64s:
    """Return ``(4, 7, 2)`` rows and columns around a pixel: four spirals out to `reach` pixels, at different angles."""
    step = np.arange(28).reshape(7, 4).T
    angle, distance = GOLDEN_ANGLE * step, reach * np.sqrt((step + 1) / 28)
    return np.round(np.stack([distance * np.sin(angle), distance * np.cos(angle)], axis=2)).astype(np.int64)


def _plate(space: BuildVolume | None, camera: Camera) -> "PlateShape":
    from amprep.kernels.picture.shade import PlateShape

    x, y = (float(space.size[0]), float(space.size[1])) if space else (0.0, 0.0)
    is_round = space is not None and space.shape == "cylinder"
    return PlateShape(x, y, is_round, 1.0 / camera.pixels_per_mm)


def _background(height: int) -> Float32s:
    fraction = np.linspace(0.0, 1.0, height)[:, None]
    rows: Floats = (1 - fraction) * np.array(linear(SKY)) + fraction * np.array(linear(FLOOR))
    return rows.astype(np.float32)


def _encoded(image: Float32s) -> Bytes:
    """Return linear light as sRGB bytes."""
    levels = np.arange(4097) / 4096
    curve = np.where(levels <= 0.0031308, 12.92 * levels, 1.055 * levels ** (1 / 2.4) - 0.055)
    bytes_of = np.round(255 * curve).astype(np.uint8)
    encoded: Bytes = bytes_of[(np.clip(image, 0.0, 1.0) * 4096).astype(np.int16)]
    return encoded
