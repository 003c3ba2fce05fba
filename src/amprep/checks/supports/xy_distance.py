"""The promise of the gap: no support comes nearer to the walls of parts than asked, measured sideways."""

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.violation import Violation
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import sample_triangles
from amprep.geometry.supports.walls import PartWalls, occupancy_of, wall_distance, walls_of
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.control import Stop
from amprep.overhangs.of_part import overhangs_of

PROMISE = "gap to walls"

SPACING = 0.3
"""mm between the points of a support that are judged, at most; the gap itself if that is less."""

_GRANT = 0.005
"""mm; along a nearly level wall a place that a file rounds up or down moves that far sideways."""

_GRANT_DEG = 0.02
"""Faces this much steeper than the threshold still count as held, so that rounding in a file breaks no promise."""


def check_gap(build: Build, stop: Stop) -> list[Violation]:
    """Judge solid supports at points all over their surface; the distance of each to the walls is exact.

    Walls are all faces that supports do not run up to. A wall counts for points on its outer side that see
    it: what is between them is no part. Walls without thickness and beams are not judged.
    """
    if build.settings.rules.gap_mm <= 0.0:
        return []
    found: list[Violation] = []
    for placed in build.parts:
        for body in build.supports:
            if stop.cancelled.is_set():
                return found
            if not body.surface and body.lattice is None:
                found += _too_near(body, placed, build)
    return found


def _too_near(body: SupportBody, placed: PlacedPart, build: Build) -> list[Violation]:
    """Judge one support beside one part."""
    reach = build.settings.rules.gap_mm - _GRANT
    walls = _walls(placed, build, stood_on=placed in [build.parts[index] for index in body.parts])
    corners = body.mesh.vertices[body.mesh.triangles]
    by_walls = occupancy_of(walls.corners.min(axis=1), walls.corners.max(axis=1))
    corners = corners[by_walls.near(corners, reach)]
    points = sample_triangles(corners, min(SPACING, build.settings.rules.gap_mm))
    for up in (0.0, 2.0 * TOLERANCE):  # what is in the part, or right below a face, is contact
        points = points[~inside(points + (0.0, 0.0, up), placed.mesh.vertices, placed.mesh.triangles)]
    away, foot = wall_distance(points, walls, reach, 2.0 * TOLERANCE)
    close = np.flatnonzero(away < reach)
    close = close[_sees(points[close], foot[close], placed)]
    if not len(close):
        return []
    worst = close[away[close].argmin()]
    place = np.round(points[worst], 2).tolist()
    message = (
        f"comes within {away[worst]:.3f} mm of a wall of {placed.label} at {place} mm, the gap is "
        f"{build.settings.rules.gap_mm:g} mm ({len(close)} of {len(points)} points)"
    )
    return [Violation(PROMISE, body.name, message)]


def _walls(placed: PlacedPart, build: Build, *, stood_on: bool) -> PartWalls:
    settings = build.settings
    needs = overhangs_of(placed, settings.rules, add_angle_deg=_GRANT_DEG)
    overlap = max(settings.overlap, CONTACT_TOLERANCE) + TOLERANCE
    stood_on = stood_on and settings.rules.grounding == "anywhere"
    return walls_of(needs.mesh.vertices, needs.mesh.triangles, needs.overhangs, overlap, stood_on=stood_on)


def _sees(points: Floats, foot: Floats, placed: PlacedPart) -> Bools:
    """Tell between which points and places on walls there is nothing of the part."""
    free = np.ones(len(points), np.bool_)
    for share in (0.2, 0.5, 0.8):
        between = points + share * (foot - points)
        free &= ~inside(between, placed.mesh.vertices, placed.mesh.triangles)
    return free
