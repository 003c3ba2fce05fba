"""Write a text on a flat face of a solid: engraved into its wall, or raised from it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.geometry.labels.faces import FlatFace
from amprep.geometry.labels.font import HEIGHT, strokes_of

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

LEAST_STROKE_MM = 0.4
"""Width of the strokes of small texts: what printers resolve."""

LEAST_WALL_MM = 0.4
"""Thickness of the wall that remains behind an engraved text."""

_STROKE_OF_HEIGHT = 0.1
_CIRCLE = 12
"""Sides of the polygons that stand for the round ends of strokes."""
_SINK = 0.05
"""Depth (mm) to which raised text enters the face, and by which engraved text begins above it."""
_TOLERANCE = 1e-3
"""Volume (mm3) that counts as rounding."""
_STEPS = 15
"""Places that are tried along each side of a face."""

TOO_SMALL, TOO_THIN, OBSTRUCTED = "too small", "too thin", "obstructed"
"""Why a face holds no text."""


class TextSize(NamedTuple):
    """A text and its size: height of the letters, and depth of the engraving, negative for raised text, mm."""

    text: str
    height: float
    depth: float

    @property
    def stroke(self) -> float:
        """Width of the strokes, mm."""
        return max(LEAST_STROKE_MM, _STROKE_OF_HEIGHT * self.height)

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height (mm) of the rectangle that contains the strokes."""
        scale = self.height / HEIGHT
        return strokes_of(self.text).width * scale + self.stroke, self.height + self.stroke


def write_on(
    solid: "Manifold", face: FlatFace, size: TextSize, place: tuple[float, float] | None = None
) -> "Manifold | str":
    """Return a solid with a text on one of its faces, or why the face does not hold it.

    The whole rectangle around the text must be in the face. Engraved text leaves a wall of at least `LEAST_WALL_MM`
    behind it, raised text must touch nothing else.

    Parameters
    ----------
    solid
        The solid.
    face
        The face.
    size
        The text.
    place
        Middle of the text in the coordinates of the face, from the middle of its bounding rectangle, mm; None for the
        free place nearest to it.
    """
    width, height = size.extent
    reason = TOO_SMALL
    for middle in _places(face, width, height) if place is None else [np.array(place) + face.middle]:
        if not face.contains(middle, width, height):
            continue
        reason = _fault(solid, face, size, middle)
        if not reason:
            text = _text(size, middle)
            body = text.extrude(abs(size.depth) + _SINK)
            low = -size.depth if size.depth > 0.0 else -_SINK
            body = body.translate((0.0, 0.0, low)).transform(face.frame[:3])
            return solid - body if size.depth > 0.0 else solid + body
    return reason


def _fault(solid: "Manifold", face: FlatFace, size: TextSize, middle: Floats) -> str:
    """Return why the text cannot be at a place; empty if it can."""
    wall = size.depth + LEAST_WALL_MM if size.depth > 0.0 else LEAST_WALL_MM
    behind = _block(face, size, middle, -wall, -_TOLERANCE)
    if (behind - solid).volume() > _TOLERANCE * (1.0 + behind.volume() / wall):
        return TOO_THIN
    above = _block(face, size, middle, _TOLERANCE, max(-size.depth, 0.0) + LEAST_WALL_MM)
    return OBSTRUCTED if (above ^ solid).volume() > _TOLERANCE else ""


def _block(face: FlatFace, size: TextSize, middle: Floats, low: float, high: float) -> "Manifold":
    """Return the block over the rectangle of a text, between two distances (mm) from the face."""
    from manifold3d import Manifold

    block = Manifold.cube((*size.extent, high - low), center=True)
    return block.translate((*middle, (low + high) / 2.0)).transform(face.frame[:3])


def _text(size: TextSize, middle: Floats) -> "CrossSection":
    """Return the outline of a text: the union of its strokes, each a rectangle with round ends."""
    from manifold3d import CrossSection, OpType

    strokes = strokes_of(size.text)
    scale = size.height / HEIGHT
    shift = middle - np.array([strokes.width, HEIGHT]) * scale / 2.0
    radius = size.stroke / 2.0 / np.cos(np.pi / _CIRCLE)
    dot = CrossSection.circle(radius, _CIRCLE)
    capsules = [
        CrossSection.batch_hull([dot.translate(tuple(scale * end + shift)) for end in ends])
        for ends in strokes.ends
    ]
    return CrossSection.batch_boolean(capsules, OpType.Add)


def _places(face: FlatFace, width: float, height: float) -> Iterator[Floats]:
    """Yield middles of rectangles in the bounding rectangle of a face, the nearest to its middle first."""
    spare = face.size - (width, height)
    if (spare < 0.0).any():
        return
    steps = np.linspace(-0.5, 0.5, _STEPS)
    places = np.stack(np.meshgrid(steps * spare[0], steps * spare[1], indexing="ij"), axis=-1).reshape(-1, 2)
    order = np.lexsort((places[:, 1], places[:, 0], np.round(np.hypot(*places.T), 9)))
    for place in places[order]:
        yield frozen(face.middle + place, np.float64)
