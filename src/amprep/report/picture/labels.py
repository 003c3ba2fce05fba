"""Draw the title of a picture and a ruler in millimetres along the plate."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.measures.density import build_height
from amprep.model import Build
from amprep.model.counting import counted
from amprep.report.picture.camera import Camera
from amprep.report.picture.colours import MARK_COLOURS
from amprep.report.triage.classes import Triage

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

INK, SOFT = (38, 46, 58), (112, 121, 134)


def draw_labels(image: "Image", build: Build, counts: Mapping[Triage, int], camera: Camera) -> "Image":
    """Draw title and ruler on a picture and return it.

    Parameters
    ----------
    image
        Modified in place.
    build
        Gives the title and the size of the plate.
    counts
        Number of findings of each class.
    camera
        Made for a picture of twice the width and height.
    """
    from PIL import ImageDraw, ImageFont

    draw = ImageDraw.Draw(image)
    unit = image.width / 1600
    draw.text((36 * unit, 28 * unit), build.settings.build_id, INK, ImageFont.load_default(30 * unit))
    draw.text((36 * unit, 68 * unit), _subtitle(build), SOFT, ImageFont.load_default(20 * unit))
    _legend(draw, counts, unit)
    _ruler(draw, build.settings.space.size, camera, unit)
    return image


def _subtitle(build: Build) -> str:
    x, y, z = build.settings.space.size.tolist()
    box = f"{x:g} x {y:g} x {z:g} mm" if build.settings.space.shape == "box" else f"⌀ {x:g} x {z:g} mm"
    items = [
        build.settings.printer,
        box,
        counted(len(build.parts), "part"),
        f"{build_height(build):.1f} mm high",
    ]
    return "   ·   ".join(item for item in items if item)


def _legend(draw: "ImageDraw", counts: Mapping[Triage, int], unit: float) -> None:
    """Draw a dot in the colour of its marks beside the number of findings of each class that has marks."""
    from PIL import ImageFont

    x, y, radius, font = 42.0 * unit, 116.0 * unit, 7.0 * unit, ImageFont.load_default(20 * unit)
    for triage, colour in MARK_COLOURS.items():
        if counts[triage]:
            words = f"{counts[triage]} {triage}"
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), colour)
            draw.text((x + 2 * radius, y), words, INK, font, anchor="lm")
            x += 4 * radius + draw.textlength(words, font) + 24 * unit


def _ruler(draw: "ImageDraw", plate: Floats, camera: Camera, unit: float) -> None:
    """Draw ticks every 10 mm and numbers every 50 mm along the two edges nearest to the viewer."""
    from PIL import ImageFont

    font = ImageFont.load_default(17 * unit)
    for axis, side in ((0, 0.0), (1, float(plate[0]))):
        outward = np.array([0.0, -1.0, 0.0]) if axis == 0 else np.array([1.0, 0.0, 0.0])
        for mark in range(0, int(plate[axis]) + 1, 10):
            at = np.array([mark, side, 0.0]) if axis == 0 else np.array([side, mark, 0.0])
            length = 4.0 if mark % 50 == 0 else 2.0
            here, there, beyond = camera.project(np.array([at, at + length * outward, at + 9.0 * outward]))
            draw.line([*(here[:2] / 2), *(there[:2] / 2)], SOFT, max(1, round(1.5 * unit)))
            if mark % 50 == 0:
                draw.text(tuple(beyond[:2] / 2), str(mark), SOFT, font, anchor="mm")
