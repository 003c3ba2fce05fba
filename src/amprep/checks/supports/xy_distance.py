"""Judge the XY distance: no support is nearer to a wall of a part than requested, measured horizontally."""

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import sample_triangles, triangle_areas
from amprep.geometry.supports.walls import PartWalls, occupancy_of, wall_distance, walls_of
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.control import Stop
from amprep.overhangs.of_part import overhangs_of

PROMISE = "XY distance to walls"

SPACING = 0.3
"""Largest distance (mm) between the judged points of a support; the XY distance itself if that is less."""

_LEAST_SPACING, _MOST_POINTS = 0.05, 2_000_000
"""Least distance (mm) of the judged points, and their number from which the distance grows."""

_TOLERANCE = 0.005
"""Horizontal error (mm) that float32 rounding causes on a nearly horizontal wall."""

_TOLERANCE_DEG = 0.02
"""Faces steeper than the overhang angle by at most this still count as overhangs, because files round coordinates."""


def check_xy_distance(build: Build, stop: Stop) -> list[Violation]:
    """Judge the exact horizontal distance of points on the surface of solid supports to the walls of parts.

    Walls are all faces that are not overhangs. A point is judged against walls on whose outer side it is, unless the
    part is between them. Walls without thickness and beams are not judged.
    """
    if build.settings.rules.gap_mm <= _TOLERANCE:
        return []
    found: list[Violation] = []
    for placed in build.parts:
        for body in build.supports:
            if stop():
                return found
            if not body.surface and body.lattice is None:
                found += _too_near(body, placed, build)
    return found


def _too_near(body: SupportBody, placed: PlacedPart, build: Build) -> list[Violation]:
    """Judge one support beside one part."""
    reach = build.settings.rules.gap_mm - _TOLERANCE
    walls = _walls(placed, build, stood_on=placed in [build.parts[index] for index in body.parts])
    corners = body.mesh.vertices[body.mesh.triangles]
    by_walls = occupancy_of(walls.corners.min(axis=1), walls.corners.max(axis=1))
    corners = corners[by_walls.near(corners, reach)]
    fewest = float(np.sqrt(triangle_areas(corners).sum() / _MOST_POINTS))
    spacing = max(min(SPACING, build.settings.rules.gap_mm), _LEAST_SPACING, fewest)
    points = sample_triangles(corners, spacing)
    for up in (0.0, 2.0 * TOLERANCE):  # points in the part or directly below a face are contact
        points = points[~inside(points + (0.0, 0.0, up), placed.mesh.vertices, placed.mesh.triangles)]
    away, foot = wall_distance(points, walls, reach, 2.0 * TOLERANCE)
    close = np.flatnonzero(away < reach)
    close = close[_sees(points[close], foot[close], placed)]
    if not len(close):
        return []
    worst = close[away[close].argmin()]
    place = place_words(points[worst])
    message = (
        f"is {away[worst]:.3f} mm from a wall of {placed.label} at {place} mm, the XY distance is "
        f"{build.settings.rules.gap_mm:g} mm ({len(close)} of {len(points)} points)"
    )
    return [Violation(PROMISE, body.name, message)]


def _walls(placed: PlacedPart, build: Build, *, stood_on: bool) -> PartWalls:
    settings = build.settings
    found = overhangs_of(placed, settings.rules, add_angle_deg=_TOLERANCE_DEG)
    overlap = max(settings.overlap, CONTACT_TOLERANCE) + TOLERANCE
    stood_on = stood_on and settings.rules.grounding == "anywhere"
    return walls_of(found.mesh.vertices, found.mesh.triangles, found.overhangs, overlap, stood_on=stood_on)


def _sees(points: Floats, foot: Floats, placed: PlacedPart) -> Bools:
    """Tell for which points the part is not between them and their nearest point on a wall."""
    free = np.ones(len(points), np.bool_)
    for fraction in (0.2, 0.5, 0.8):
        between = points + fraction * (foot - points)
        free &= ~inside(between, placed.mesh.vertices, placed.mesh.triangles)
    return free
