"""Draw builds and meshes as PNG pictures, without a graphics card."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.files import replacing
from amprep.model import Build, Mesh
from amprep.report.picture.camera import Camera, box_corners, fitted, view_axes
from amprep.report.picture.labels import draw_labels
from amprep.report.picture.render import render
from amprep.report.picture.scene import (
    PART_KIND,
    ColouredMesh,
    build_meshes,
    finding_marks,
    plate_mesh,
    seen_through,
)
from amprep.report.record import BuildRecord
from amprep.report.triage.findings import Finding, build_findings
from amprep.report.triage.groups import count_by_triage

if TYPE_CHECKING:
    from PIL.Image import Image

VIEW = view_axes(-62.0, 34.0)
"""Axes of a viewer in front of the build and to the right, looking down."""


def write_picture(
    build: Build,
    path: Path,
    findings: Sequence[Finding] | None = None,
    *,
    size: tuple[int, int] = (1600, 1200),
) -> None:
    """Write a picture of a build as PNG.

    It shows the build plate with lines every 10 and 50 mm, parts in different colours, and supports. These are faintly
    visible through parts, so that legs and braces inside and behind them are seen. What must be fixed is marked red,
    and what is worth a check orange.

    Parameters
    ----------
    build, path
        The build and the file; the file appears complete, or not at all.
    findings
        What was found about the build; None for its unsupported regions.
    size
        Width and height in pixels.
    """
    found = build_findings(BuildRecord(build)) if findings is None else findings
    _save(build_picture(build, found, size), path)


def build_picture(build: Build, findings: Sequence[Finding], size: tuple[int, int] = (1600, 1200)) -> "Image":
    """Return the picture that `write_picture` writes."""
    from PIL import Image

    meshes = build_meshes(build)
    space = build.settings.space
    camera = _camera(meshes, space.size, size)
    marks = finding_marks(findings, min_radius=5.0 / camera.pixels_per_mm)
    marks += seen_through(build, VIEW[2])
    plate = plate_mesh(np.zeros(3), space.size)
    pixels = render([plate, *meshes], marks, camera, size, space)
    return draw_labels(Image.fromarray(pixels), build, count_by_triage(findings), camera)


def draw_mesh(
    mesh: Mesh, path: Path, *, size: tuple[int, int] = (1200, 900), colour: str = "#6b8ead"
) -> None:
    """Write a picture of a mesh as PNG, seen from the same side as builds.

    Parameters
    ----------
    mesh, path
        The mesh and the file; the file appears complete, or not at all.
    size
        Width and height in pixels.
    colour
        ``#rrggbb``.
    """
    from PIL import Image

    camera = fitted(VIEW, box_corners(*mesh.bounds), (2 * size[0], 2 * size[1]), margin=120.0)
    _save(Image.fromarray(render([ColouredMesh(mesh, colour, PART_KIND)], (), camera, size, None)), path)


def _camera(meshes: list[ColouredMesh], plate: Floats, size: tuple[int, int]) -> Camera:
    """Return a view of the whole plate, or of the meshes if they cover only a small part of it."""
    low, high = np.zeros(3), plate * np.array([1.0, 1.0, 0.0])
    filled = [each.mesh for each in meshes if len(each.mesh.vertices)]
    if filled:
        least = np.min([mesh.bounds[0] for mesh in filled], axis=0)
        most = np.max([mesh.bounds[1] for mesh in filled], axis=0)
        high[2] = most[2]
        if np.max(most[:2] - least[:2]) < 0.45 * np.max(plate[:2]):
            low[:2], high[:2] = np.maximum(low[:2], least[:2] - 15.0), np.minimum(high[:2], most[:2] + 15.0)
    return fitted(VIEW, box_corners(low, high), (2 * size[0], 2 * size[1]), margin=0.045 * 2 * size[0])


def _save(image: "Image", path: Path) -> None:
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", compress_level=4)
