"""The flat faces of a mesh on which a text can be read: those that look up or to the side."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s, frozen
from amprep.geometry.slicing.planar_faces import find_planar_faces

if TYPE_CHECKING:
    from manifold3d import CrossSection

_LEVEL = 1e-3
"""Largest deviation of a normal from up, or of its z from 0, for faces that look up or to the side."""
_NEGLIGIBLE = 1e-4
"""Fraction of a rectangle that may be outside a face by rounding."""

NAMES = ("top", "front", "back", "left", "right", "side")
"""Directions by which a face is named; ``side`` is any that looks to the side."""


@dataclass(frozen=True, eq=False)
class FlatFace:
    """A flat face with the coordinates in which a text on it reads upright.

    Attributes
    ----------
    frame
        ``(4, 4)``, coordinates of the face (x along the line of text, y up, z outwards) to those of the mesh.
    corners
        ``(t, 3, 2)`` mm, its triangles in its own coordinates.
    area
        mm2.
    """

    frame: Floats
    corners: Floats
    area: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame", frozen(self.frame, np.float64).reshape(4, 4))
        object.__setattr__(self, "corners", frozen(self.corners, np.float64).reshape(-1, 3, 2))

    @cached_property
    def outline(self) -> "CrossSection":
        """The face as a plane region."""
        from manifold3d import CrossSection, FillRule

        return CrossSection([each.copy() for each in self.corners], FillRule.NonZero)

    @property
    def middle(self) -> Floats:
        """Middle of its bounding rectangle, mm."""
        points = self.corners.reshape(-1, 2)
        return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2.0)

    @property
    def size(self) -> Floats:
        """Sides of its bounding rectangle, mm."""
        return np.asarray(np.ptp(self.corners.reshape(-1, 2), axis=0))

    @property
    def normal(self) -> Floats:
        """The direction in which it looks."""
        return self.frame[:3, 2]

    def turned(self) -> "FlatFace":
        """Return the face with lines of text that run upwards instead of to the right."""
        frame = self.frame.copy()
        frame[:3, 0], frame[:3, 1] = self.frame[:3, 1], -self.frame[:3, 0]
        return FlatFace(frame, np.stack([self.corners[..., 1], -self.corners[..., 0]], axis=-1), self.area)

    def contains(self, middle: Floats, width: float, height: float) -> bool:
        """Tell whether a rectangle (mm) with this middle is in the face."""
        from manifold3d import CrossSection

        rectangle = CrossSection.square((width, height), center=True).translate(tuple(middle))
        return bool((rectangle - self.outline).area() <= _NEGLIGIBLE * width * height)

    def looks(self, name: str) -> bool:
        """Tell whether it looks in the direction of a name."""
        x, y, z = self.normal.tolist()
        directions = {"top": z, "front": -y, "back": y, "left": -x, "right": x}
        return bool(abs(z) < 0.5 if name == "side" else directions[name] > 1.0 - 10.0 * _LEVEL)


def find_flat_faces(vertices: Floats, triangles: Int64s) -> Sequence[FlatFace]:
    """Return the faces of a mesh that look up or to the side, the largest first; faces of overhangs are left out.

    Of faces of equal area those that look up come first, then those that look to the front.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm, ``(m, 3)`` indices.
    """
    found = find_planar_faces(vertices, triangles)
    corners = found.points[found.triangles]
    areas = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
    )
    area = np.bincount(found.label, areas, len(found.normal))
    z = found.normal[:, 2]
    legible = np.flatnonzero((z > 1.0 - _LEVEL) | (np.abs(z) < _LEVEL) & (area > 0.0))
    faces = [_face(found.normal[each], corners[found.label == each], float(area[each])) for each in legible]
    return sorted(faces, key=lambda each: (-round(each.area, 3), -each.normal[2], each.normal[1]))


def _face(normal: Floats, corners: Floats, area: float) -> FlatFace:
    """Return a face with its coordinates: the line of text is level, and on level faces along x."""
    along = np.array([1.0, 0.0, 0.0]) if normal[2] > 0.5 else np.cross([0.0, 0.0, 1.0], normal)
    along = along - normal * (along @ normal)
    along /= np.linalg.norm(along)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2] = along, np.cross(normal, along), normal
    frame[:3, 3] = normal * float(corners.reshape(-1, 3).mean(axis=0) @ normal)
    return FlatFace(frame, (corners - frame[:3, 3]) @ frame[:3, :2], area)
