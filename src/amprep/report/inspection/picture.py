"""Draw a bounding volume: on the left the part with the outlines of the volume, on the right its pieces."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.files import replacing
from amprep.model.bounding_volume import TurnedVolume
from amprep.model.mesh import Mesh, join_meshes
from amprep.model.volume_meshes import meshes_of
from amprep.report.picture import VIEW
from amprep.report.picture.camera import box_corners, fitted
from amprep.report.picture.colours import PALETTE, VOLUME
from amprep.report.picture.render import render
from amprep.report.picture.scene import PART_KIND, ColouredMesh

if TYPE_CHECKING:
    from PIL.Image import Image

_PART = "#8fa3b8"
_CREASE = 0.88
"""Cosine of the angle between two triangles above which their common edge is not drawn."""
_LINE_PIXELS = 5.0
"""Width of an outline in pixels of the picture at twice its size."""
_INK, _SOFT = (38, 46, 58), (112, 121, 134)


def draw_volume(
    part: Mesh, made: TurnedVolume, title: str, words: str, path: Path, *, size: tuple[int, int] = (800, 680)
) -> None:
    """Write a picture of a part and its bounding volume as PNG, in the orientation of the volume.

    Parameters
    ----------
    part, made
        The mesh in part coordinates, and its bounding volume.
    title, words
        Headings.
    path
        The file; it appears complete, or not at all.
    size
        Width and height of each half in pixels.
    """
    from PIL import Image

    turned = Mesh(part.vertices @ made.rotation.T, part.triangles)
    pieces = meshes_of(made.volume)
    low, high = join_meshes([turned, *pieces]).bounds
    camera = fitted(VIEW, box_corners(low, high), (2 * size[0], 2 * size[1]), margin=0.22 * size[1])
    lines = outlines(pieces, _LINE_PIXELS / camera.pixels_per_mm)
    marks = [ColouredMesh(lines, VOLUME, PART_KIND)] if len(lines.triangles) else []
    beside = np.eye(4)
    beside[:3, 3] = VIEW[0] * 2 * size[0] / camera.pixels_per_mm
    colours = PALETTE if len(pieces) > 1 else (VOLUME,)
    shown = [
        ColouredMesh(piece.moved(beside), colours[number % len(colours)], PART_KIND)
        for number, piece in enumerate(pieces)
    ]
    scene = [ColouredMesh(turned, _PART, PART_KIND), *shown]
    pixels = render(scene, marks, camera, (2 * size[0], size[1]), None)
    image = _labelled(Image.fromarray(pixels), title, words)
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", compress_level=4)


def outlines(pieces: tuple[Mesh, ...], width: float) -> Mesh:
    """Return the sharp edges of meshes as bars of `width` mm with three sides."""
    ends = [_sharp_edges(piece) for piece in pieces]
    starts, stops = (np.concatenate([each[side] for each in ends]) for side in (0, 1))
    return _bars(starts, stops, width)


def _sharp_edges(mesh: Mesh) -> tuple[Floats, Floats]:
    """Return the ends ``(k, 3)`` of the edges whose triangles meet at an angle, and of those of one triangle."""
    triangles = mesh.triangles.astype(np.int64)
    corners = mesh.vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    keys = np.minimum(start, end) * len(mesh.vertices) + np.maximum(start, end)
    order = np.argsort(keys, kind="stable")
    first = np.flatnonzero(np.diff(keys[order], prepend=-1))
    counts = np.diff(np.append(first, len(order)))
    one, other = order[first], order[first + np.minimum(counts, 2) - 1]
    sharp = (counts != 2) | (np.einsum("ij,ij->i", normal[one // 3], normal[other // 3]) < _CREASE)
    return mesh.vertices[start[one[sharp]]], mesh.vertices[end[one[sharp]]]


def _bars(starts: Floats, stops: Floats, width: float) -> Mesh:
    along = stops - starts
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    least = np.eye(3)[np.abs(along).argmin(axis=1)]
    side = np.cross(along, least)
    side /= np.maximum(np.linalg.norm(side, axis=1), 1e-300)[:, None]
    up, angles = np.cross(along, side), 2.0 * np.pi / 3.0 * np.arange(3)
    ring = (
        0.5
        * width
        * (np.cos(angles)[None, :, None] * side[:, None] + np.sin(angles)[None, :, None] * up[:, None])
    )
    vertices = np.concatenate([starts[:, None] + ring, stops[:, None] + ring], axis=1).reshape(-1, 3)
    sides = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]], np.int32)
    triangles = sides[None] + 6 * np.arange(len(starts), dtype=np.int32)[:, None, None]
    return Mesh(vertices, triangles.reshape(-1, 3))


def _labelled(image: "Image", title: str, words: str) -> "Image":
    from PIL import ImageDraw, ImageFont

    draw, unit = ImageDraw.Draw(image), image.width / 1600
    draw.text((36 * unit, 24 * unit), title, _INK, ImageFont.load_default(28 * unit))
    draw.text((36 * unit, 62 * unit), words, _SOFT, ImageFont.load_default(19 * unit))
    return image
