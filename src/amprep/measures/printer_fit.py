"""Tell whether a part fits a build volume as it is, in an allowed orientation, or in any other."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.geometry.boxes.build_space import Space, find_feasible_position
from amprep.geometry.boxes.footprint import convex_outline, enclosing_radius, flush_angles
from amprep.model.build_volume import BuildVolume
from amprep.model.part import Orientations
from amprep.model.rotations import axis_rotations

Fit = Literal["as it lies", "in an allowed orientation", "in another orientation", "does not fit"]

_MOST_FACES = 60
"""Number of faces of the convex hull, largest first, on which the part is set down."""
_MOST_ANGLES = 90
"""Number of angles about z that are tried with each of them."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Sizes of a part in several orientations.

    Attributes
    ----------
    size
        ``(k, 3)`` mm, sides of the bounding box.
    radius
        ``(k,)`` mm, radius of the smallest circle around the footprint.
    """

    size: Floats
    radius: Floats


@dataclass(frozen=True, eq=False)
class PartPoses:
    """Sizes of a part as it lies, in the orientations that it allows, and in others that are tried."""

    lying: Poses
    allowed: Poses
    others: Poses

    def fit(self, space: BuildVolume, clearance: float, lift: float) -> Fit:
        """Return the first way in which the part fits.

        Orientations about a continuous axis are tried at the angles at which a side of the footprint is parallel to a
        wall and at every second degree; any other orientation is tried with each large face of the convex hull on the
        plate. A build volume with forbidden zones is tried with the bounding box of the part.

        Parameters
        ----------
        space
            Build volume of the printer.
        clearance
            Distance from the walls and the top, mm.
        lift
            Height above the plate, mm.
        """
        ways: tuple[tuple[Fit, Poses], ...] = (
            ("as it lies", self.lying),
            ("in an allowed orientation", self.allowed),
            ("in another orientation", self.others),
        )
        return next((way for way, poses in ways if _fits(poses, space, clearance, lift)), "does not fit")


def poses_of(points: Floats, orientations: Orientations) -> PartPoses:
    """Return the sizes of a part in its orientations.

    Parameters
    ----------
    points
        ``(n, 3)`` mm, the vertices.
    orientations
        Orientations that the part allows.
    """
    hull = _hull_points(points)
    tried = np.concatenate([axis_rotations(), _faces_down(hull)])
    if orientations.freedom == "list":
        allowed = _listed(hull, orientations.matrices)
    elif orientations.freedom == "about-z":
        allowed = _about_z(hull, np.eye(3)[None])
    else:
        allowed = _about_z(hull, tried)
    return PartPoses(_poses(hull, np.eye(3)), allowed, _about_z(hull, tried))


def which_fit(points: Floats, rotations: Floats, space: BuildVolume, clearance: float, lift: float) -> Bools:
    """Tell which rotations ``(k, 3, 3)`` of a part with vertices `points` fit the build volume, ``(k,)``.

    Clearance and lift are those of `PartPoses.fit`.
    """
    hull = _hull_points(points)
    return np.array(
        [_fits(_poses(hull, rotation), space, clearance, lift) for rotation in rotations], np.bool_
    )


def _fits(poses: Poses, space: BuildVolume, clearance: float, lift: float) -> bool:
    slack = CONTACT_TOLERANCE
    room = space.size - np.array([2.0 * clearance, 2.0 * clearance, lift + clearance])
    within = poses.size[:, 2] <= room[2] + slack
    if space.shape == "cylinder":
        within &= poses.radius <= space.size[0] / 2.0 - clearance + slack / 2.0
    else:
        within &= (poses.size[:, :2] <= room[:2] + slack).all(axis=1)
    if not len(space.zone_lo):
        return bool(within.any())
    empty = _space(space, clearance, lift)
    sizes = np.unique(np.round(poses.size[within], 6), axis=0)
    return any(find_feasible_position(np.zeros((1, 3)), size[None], empty) is not None for size in sizes)


def _space(space: BuildVolume, clearance: float, lift: float) -> Space:
    radius = max(float(space.size[0]) / 2.0 - clearance, 1e-9) if space.shape == "cylinder" else 0.0
    lo = np.array([clearance, clearance, lift])
    zones = space.zone_lo, space.zone_hi
    return Space(lo, space.size - clearance, space.size[:2] / 2.0, radius, *zones, False, CONTACT_TOLERANCE)


def _poses(points: Floats, rotation: Floats, angles: Floats | None = None) -> Poses:
    """Return the sizes under a rotation followed by each angle about z (radians); the angle 0 by default."""
    turned = points @ rotation.T
    outline = convex_outline(turned[:, :2])
    if angles is None:
        angles = np.zeros(1)
    along, across = np.array([np.cos(angles), -np.sin(angles)]), np.array([np.sin(angles), np.cos(angles)])
    height = np.full(len(angles), np.ptp(turned[:, 2]))
    size = np.stack([np.ptp(outline @ along, axis=0), np.ptp(outline @ across, axis=0), height], axis=1)
    return Poses(size, np.full(len(angles), enclosing_radius(outline)))


def _listed(points: Floats, rotations: Floats) -> Poses:
    return _joined([_poses(points, rotation) for rotation in rotations])


def _about_z(points: Floats, rotations: Floats) -> Poses:
    """Return the sizes under each rotation followed by turns about z that may make the footprint small."""
    found = []
    for rotation in rotations:
        flush = flush_angles(convex_outline((points @ rotation.T)[:, :2]))[:_MOST_ANGLES]
        found.append(_poses(points, rotation, np.concatenate([np.radians(np.arange(0, 180, 2.0)), flush])))
    return _joined(found)


def _joined(found: list[Poses]) -> Poses:
    return Poses(
        np.concatenate([each.size for each in found]), np.concatenate([each.radius for each in found])
    )


def _hull_points(points: Floats) -> Floats:
    from manifold3d import Manifold

    hull = Manifold.hull_points(np.ascontiguousarray(points))
    vertices: Floats = np.asarray(hull.to_mesh64().vert_properties[:, :3], np.float64)
    return vertices if len(vertices) else np.asarray(points)


def _faces_down(hull: Floats) -> Floats:
    """Return rotations ``(k, 3, 3)`` that set the large faces of the convex hull on the plate."""
    from manifold3d import Manifold

    mesh = Manifold.hull_points(np.ascontiguousarray(hull)).to_mesh64()
    corners = np.asarray(mesh.vert_properties[:, :3])[np.asarray(mesh.tri_verts, np.int64)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    unit = np.round(normal[area > 0] / area[area > 0, None], 6)
    faces, label = np.unique(unit, axis=0, return_inverse=True)
    total = np.bincount(label.reshape(-1), area[area > 0], len(faces))
    chosen = faces[np.argsort(-total, kind="stable")[:_MOST_FACES]]
    return np.array([_downwards(direction) for direction in chosen]).reshape(-1, 3, 3)


def _downwards(direction: Floats) -> Floats:
    """Return a rotation that turns a unit vector to -z."""
    down = -direction / np.linalg.norm(direction)
    side = np.cross(down, [0.0, 0.0, 1.0] if abs(down[2]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    return np.array([side, np.cross(down, side), down])
