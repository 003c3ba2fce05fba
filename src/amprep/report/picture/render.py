"""Turns bodies and a camera into pixels: arrays for the kernels in `amprep.kernels.raster`, and back."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.model import BuildVolume
from amprep.report.picture.camera import Camera, box_corners, fitted, view_axes
from amprep.report.picture.scene import Body, Scene, assemble, linear, unit_normals

SUN = view_axes(-112.0, 56.0)
"""The direction of light, as the axes of a viewer who stands in the sun."""
SHADOW_CELLS = 2048
GOLDEN_ANGLE = 2.399963
SKY, FLOOR = "#fdfdfe", "#e4e8ee"
"""Colours of the background, at the top and at the bottom."""


@dataclass(frozen=True, eq=False)
class _Buffers:
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]


def render(
    bodies: list[Body], marks: Body | None, camera: Camera, size: tuple[int, int], space: BuildVolume | None
) -> NDArray[np.uint8]:
    """Return the picture ``(height, width, 3)``; the camera is made for twice that size.

    Parameters
    ----------
    marks
        Drawn over everything, faintly where something hides them.
    space
        Gives the plate its size and shape; None without a plate.
    """
    from amprep.kernels.raster import shade

    scene = assemble(bodies)
    main = _drawn(scene.vertices, scene.triangles, camera, size)
    over, mark_colours = _drawn_marks(marks, camera, size)
    sun, shadow = _shadow(scene)
    normals, facets = _lit(scene, camera)
    reach = max(3.0, 60.0 / camera.pixels_per_mm)
    image = np.zeros((size[1], size[0], 3), np.float32)
    shade(
        main.ids, main.depth, over.ids, over.depth, shadow, camera.inverse, _chained(sun, camera),
        facets, normals, scene.kinds, scene.owner, scene.colours,
        mark_colours, _offsets(reach * camera.pixels_per_mm),
        _plate(space, camera, reach, 0.3 + 2.0 / sun.pixels_per_mm), _background(size[1]), image,
    )  # fmt: skip
    return _encoded(image)


def _drawn(vertices: Floats, triangles: NDArray[np.int32], camera: Camera, size: tuple[int, int]) -> _Buffers:
    from amprep.kernels.raster import draw

    shape = (2 * size[1], 2 * size[0])
    buffers = _Buffers(np.full(shape, np.inf, np.float32), np.full(shape, -1, np.int32))
    draw(camera.project(vertices), triangles, 0, buffers.depth, buffers.ids)
    return buffers


def _drawn_marks(
    marks: Body | None, camera: Camera, size: tuple[int, int]
) -> tuple[_Buffers, NDArray[np.float32]]:
    if marks is None:
        nothing = np.empty((0, 3))
        return _drawn(nothing, np.empty((0, 3), np.int32), camera, size), np.empty((0, 3), np.float32)
    mesh = marks.mesh
    triangles = (
        mesh.triangles.copy()
    )  # writable like the scene's: a read-only array would compile `draw` again
    facing = -unit_normals(mesh.vertices, mesh.triangles) @ camera.axes[2]
    tones = (0.5 + 0.5 * np.maximum(facing, 0.0))[:, None] * np.array(linear(marks.colour))
    return _drawn(mesh.vertices, triangles, camera, size), tones.astype(np.float32)


def _shadow(scene: Scene) -> tuple[Camera, NDArray[np.float32]]:
    """Return the sun's view and the depth that it sees."""
    from amprep.kernels.raster import PLATE, draw

    casting = scene.triangles[scene.kinds != PLATE]
    corners = box_corners(scene.vertices.min(axis=0), scene.vertices.max(axis=0))
    camera = fitted(SUN, corners, (SHADOW_CELLS, SHADOW_CELLS), margin=4.0)
    depth = np.full((SHADOW_CELLS, SHADOW_CELLS), np.inf, np.float32)
    draw(camera.project(scene.vertices), casting, 0, depth, np.empty((0, 0), np.int32))
    return camera, depth


def _chained(sun: Camera, camera: Camera) -> Floats:
    """Return the ``(3, 4)`` map from the camera's column, row, depth to the sun's."""
    back: Floats = np.vstack([camera.inverse, [0.0, 0.0, 0.0, 1.0]])
    chained: Floats = sun.matrix @ back
    return chained


def _lit(scene: Scene, camera: Camera) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return normals and facets, see `light_facets`."""
    from amprep.kernels.raster import light_facets

    normals = np.zeros((len(scene.triangles), 3), np.float32)
    facets = np.zeros((len(scene.triangles), 4), np.float32)
    light_facets(scene.vertices, scene.triangles, camera.axes, SUN[2], camera.pixels_per_mm, normals, facets)
    return normals, facets


def _offsets(reach: float) -> NDArray[np.int64]:
    """Return ``(4, 7, 2)`` rows and columns around a pixel: four spirals, turned, out to `reach` pixels."""
    step = np.arange(28).reshape(7, 4).T
    angle, distance = GOLDEN_ANGLE * step, reach * np.sqrt((step + 1) / 28)
    return np.round(np.stack([distance * np.sin(angle), distance * np.cos(angle)], axis=2)).astype(np.int64)


def _plate(space: BuildVolume | None, camera: Camera, reach: float, bias: float) -> Floats:
    x, y = (float(space.size[0]), float(space.size[1])) if space else (0.0, 0.0)
    is_round = float(space is not None and space.shape == "cylinder")
    return np.array([x, y, is_round, 1.0 / camera.pixels_per_mm, reach, bias])


def _background(height: int) -> NDArray[np.float32]:
    share = np.linspace(0.0, 1.0, height)[:, None]
    rows: Floats = (1 - share) * np.array(linear(SKY)) + share * np.array(linear(FLOOR))
    return rows.astype(np.float32)


def _encoded(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return linear light as sRGB bytes."""
    levels = np.arange(4097) / 4096
    curve = np.where(levels <= 0.0031308, 12.92 * levels, 1.055 * levels ** (1 / 2.4) - 0.055)
    bytes_of = np.round(255 * curve).astype(np.uint8)
    encoded: NDArray[np.uint8] = bytes_of[(np.clip(image, 0.0, 1.0) * 4096).astype(np.int16)]
    return encoded
