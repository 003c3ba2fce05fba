"""Draw the proposed orientations of a part side by side, with the overhangs that need support in red."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from amprep.files import replacing
from amprep.model.mesh import Mesh
from amprep.report.picture.camera import Camera, box_corners, fitted, view_axes
from amprep.report.picture.colours import MARK_COLOURS
from amprep.report.picture.render import render
from amprep.report.picture.scene import PART_KIND, ColouredMesh
from amprep.report.triage.classes import MUST_FIX

PART, OVERHANG = "#8fa3b8", MARK_COLOURS[MUST_FIX]
"""Colours of the part, and of its overhangs, which are faintly visible through it."""

_VIEW = view_axes(-62.0, 14.0)
"""From the front, a little above the plate, where overhangs are seen best."""

_INK = (38, 46, 58)
_MARGIN = 0.1


@dataclass(frozen=True, eq=False)
class ShownOrientation:
    """A part in an orientation.

    Attributes
    ----------
    name
        What the row of the table is called: ``1``, ``drawn``.
    mesh, overhangs
        The part as it stands, and the faces of it that need support.
    """

    name: str
    mesh: Mesh
    overhangs: Mesh


def draw_orientations(shown: Sequence[ShownOrientation], path: Path, *, side: int = 420) -> None:
    """Write a picture of orientations as PNG, one beside the other and all to the same scale.

    Parameters
    ----------
    shown
        The orientations.
    path
        The file; it appears complete, or not at all.
    side
        Width and height of each in pixels.
    """
    from PIL import Image, ImageDraw, ImageFont

    cameras = [_camera(each, side) for each in shown]
    scale = min(camera.pixels_per_mm for camera in cameras)
    sheet = Image.new("RGB", (side * len(shown), side))
    draw = ImageDraw.Draw(sheet)
    for number, (each, camera) in enumerate(zip(shown, cameras, strict=True)):
        marks = [ColouredMesh(each.overhangs, OVERHANG, PART_KIND)] if len(each.overhangs.triangles) else []
        scene = [ColouredMesh(each.mesh, PART, PART_KIND)]
        pixels = render(scene, marks, _scaled(camera, scale, side), (side, side), None)
        sheet.paste(Image.fromarray(pixels), (side * number, 0))
        draw.text((side * number + 16, 10), each.name, _INK, ImageFont.load_default(22))
    with replacing(path) as temporary:
        sheet.save(temporary, format="PNG", compress_level=4)


def _camera(each: ShownOrientation, side: int) -> Camera:
    return fitted(_VIEW, box_corners(*each.mesh.bounds), (2 * side, 2 * side), margin=2 * side * _MARGIN)


def _scaled(camera: Camera, scale: float, side: int) -> Camera:
    """Return the camera with another scale, and the same point in the middle of the picture."""
    middle = np.array([side, side, 0.0])
    return Camera(camera.axes, middle - (middle - camera.offset) * scale / camera.pixels_per_mm, scale)
