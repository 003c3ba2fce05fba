"""Pictures of builds and meshes as PNG, drawn without a graphics card."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.files import replacing
from amprep.model import Build, Mesh
from amprep.report.picture.camera import Camera, box_corners, fitted, view_axes
from amprep.report.picture.labels import draw_labels
from amprep.report.picture.render import render
from amprep.report.picture.scene import PART_KIND, Body, build_bodies, plate_body, unsupported_marks

if TYPE_CHECKING:
    from PIL.Image import Image

VIEW = view_axes(-62.0, 34.0)
"""The viewer stands in front, a little to the right, and looks down."""


def write_picture(build: Build, path: Path, *, size: tuple[int, int] = (1600, 1200)) -> None:
    """Write the build as a PNG: plate with a grid in mm, parts by colour, supports, the unsupported in red.

    Parameters
    ----------
    size
        Width and height in pixels.
    """
    _save(build_picture(build, size), path)


def build_picture(build: Build, size: tuple[int, int] = (1600, 1200)) -> "Image":
    """Return the picture that `write_picture` writes."""
    from PIL import Image

    bodies = build_bodies(build)
    space = build.settings.space
    camera = _camera(bodies, space.size, size)
    marks = unsupported_marks(build, least_radius=5.0 / camera.pixels_per_mm)
    plate = plate_body(np.zeros(3), space.size)
    pixels = render([plate, *bodies], marks, camera, size, space)
    return draw_labels(Image.fromarray(pixels), build, camera)


def draw_mesh(
    mesh: Mesh, path: Path, *, size: tuple[int, int] = (1200, 900), colour: str = "#6b8ead"
) -> None:
    """Write a single mesh as a PNG, seen from the same side as builds."""
    from PIL import Image

    body = Body(mesh, colour, PART_KIND)
    camera = fitted(VIEW, box_corners(*mesh.bounds), (2 * size[0], 2 * size[1]), margin=120.0)
    _save(Image.fromarray(render([body], None, camera, size, None)), path)


def _camera(bodies: list[Body], plate: Floats, size: tuple[int, int]) -> Camera:
    """Return a view of the whole plate, or of what stands on it when that is much smaller."""
    low, high = np.zeros(3), plate * np.array([1.0, 1.0, 0.0])
    filled = [body for body in bodies if len(body.mesh.vertices)]
    if filled:
        least = np.min([body.mesh.bounds[0] for body in filled], axis=0)
        most = np.max([body.mesh.bounds[1] for body in filled], axis=0)
        high[2] = most[2]
        if np.max(most[:2] - least[:2]) < 0.45 * np.max(plate[:2]):
            low[:2], high[:2] = np.maximum(low[:2], least[:2] - 15.0), np.minimum(high[:2], most[:2] + 15.0)
    return fitted(VIEW, box_corners(low, high), (2 * size[0], 2 * size[1]), margin=0.045 * 2 * size[0])


def _save(image: "Image", path: Path) -> None:
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", compress_level=4)
