"""Smallest enclosing box over the orientations that a part allows (thesis 2.3)."""

from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.orientation import (
    flat_rotation,
    hull_of,
    smallest_box_about_z,
    smallest_box_rotation,
)
from amprep.model.bounding_volume import Boxes, TurnedVolume
from amprep.model.control import Stop
from amprep.model.part import Part

_GAIN = 1e-9
"""Fraction of the volume that a rotation must save."""


def oriented_box(
    part: Part,
    *,
    params: Any,  # noqa: ARG001
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,  # noqa: ARG001
) -> Boxes | TurnedVolume:
    """Return the smallest enclosing box, in the orientation in which it is axis-parallel.

    A part that may be rotated freely is tried with each face of its convex hull parallel to the plate, one that may
    be rotated about z with each side of its outline parallel to an axis, any other one in all its orientations. The
    part is not turned if that saves nothing.
    """
    vertices = part.mesh.vertices[np.unique(part.mesh.triangles)]
    upright = _enclosing(vertices, np.eye(3))
    rotation = _best_rotation(vertices, part)
    box = _enclosing(vertices, rotation)
    if _volume(box) >= _volume(upright) * (1 - _GAIN):
        return Boxes(upright[0][None], upright[1][None])
    return TurnedVolume(Boxes(box[0][None], box[1][None]), rotation)


def _best_rotation(vertices: Floats, part: Part) -> Floats:
    allowed = part.orientations
    if allowed.freedom == "about-z":
        return smallest_box_about_z(vertices)[1]
    if allowed.freedom == "free":
        hull = hull_of(vertices)
        return flat_rotation(vertices) if hull is None else smallest_box_rotation(hull)[1]
    return min(allowed.matrices, key=lambda matrix: _volume(_enclosing(vertices, matrix)))


def _enclosing(vertices: Floats, rotation: Floats) -> tuple[Floats, Floats]:
    turned = vertices @ rotation.T
    return turned.min(axis=0), turned.max(axis=0)


def _volume(box: tuple[Floats, Floats]) -> float:
    return float(np.prod(box[1] - box[0]))
