"""Directions in which a part may be built, with quick figures of each."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.bounding.boxes.orientation import Hull, hull_of, smallest_box_rotation
from amprep.geometry.orientation.choice import apart, ranked
from amprep.geometry.orientation.directions import (
    around,
    distinct,
    flat_face_directions,
    hull_directions,
    sphere_directions,
)
from amprep.geometry.orientation.quick_figures import (
    QuickFigures,
    carried_fractions,
    quick_figures,
    support_estimate,
)
from amprep.geometry.orientation.surface import TurnableSurface, turnable_surface
from amprep.geometry.orientation.tipping import centre_of_mass, tipping_angles
from amprep.geometry.overhangs.carried.points import Limits
from amprep.model.orientation import EDGE_MM, FIRM_DEG, HOLD_MM2, OrientationRules
from amprep.model.part import Part
from amprep.model.supports.rules import SupportRules
from amprep.orienting.faces import FaceMasks, face_masks
from amprep.overhangs.blockers import apply_regions

SPHERE = 1000
"""Number of directions spread over the sphere."""

_HULL_FACES, _FLAT_FACES = 150, 60
"""Greatest number of directions from faces of the convex hull, and from flat faces of the part."""

_SEEDS, _RINGS_DEG, _AROUND = 6, (4.0, 2.0, 1.0, 0.5), 8
"""Number of directions that are refined, angles of the steps, and number of directions tried around one."""

_FACING = float(np.cos(np.pi / 4.0)) - 1e-9
"""Least cosine of the angle between the normal of a face that must look up or down and the vertical."""

_TOUCHED_MM2 = 0.05
"""Area up to which faces that nothing may touch may still be touched: it is within the error of the quick figures."""


class TurnablePart(NamedTuple):
    """A part prepared for figures in many directions.

    Attributes
    ----------
    surface
        Its surface.
    hull
        Its convex hull; None if all of its points are in a plane.
    carried
        ``(m,)`` fraction of each triangle that needs no support where it points down.
    enforced
        ``(m,)`` bool, triangles that need support wherever they point down; None for none.
    limits
        Overhang angle and limits.
    lift
        Height (mm) of its lowest point above the plate.
    faces
        The faces that restrict its orientation.
    tilt_deg
        Largest angle of the direction that points up to the one as drawn.
    centre
        ``(3,)`` mm, centre of mass.
    """

    surface: TurnableSurface
    hull: Hull | None
    carried: Floats
    enforced: Bools | None
    limits: Limits
    lift: float
    faces: FaceMasks
    tilt_deg: float
    centre: Floats

    def figures(self, directions: Floats) -> QuickFigures:
        """Return the quick figures of directions ``(k, 3)``."""
        return quick_figures(
            self.surface,
            directions,
            self.limits,
            lift=self.lift,
            carried=self.carried,
            enforced=self.enforced,
        )

    def tipping(self, directions: Floats) -> Floats:
        """Return the angles (degrees) by which the part must be tilted until it tips over, ``(k,)``."""
        return tipping_angles(self.outer_points, self.centre, directions, self.limits.plate)

    def projected_areas(self, directions: Floats) -> Floats:
        """Return the areas (mm2) of the projections of the convex hull along directions, ``(k,)``."""
        if self.hull is None:
            return np.zeros(len(directions))
        return np.asarray(self.hull.areas @ np.abs(self.hull.normals @ directions.T) / 2.0)

    @property
    def outer_points(self) -> Floats:
        """The corners ``(n, 3)`` of the convex hull, mm; all points if they are in a plane."""
        return self.surface.points if self.hull is None else self.hull.points

    def costs(self, directions: Floats, quick: QuickFigures | None = None) -> Floats:
        """Return the estimates of support of directions, ``(k,)``; of their figures if these are known.

        Below a part that does not stand by itself is a column, unless the lift has supports below it anyway.
        """
        quick = self.figures(directions) if quick is None else quick
        area, volume = quick.plan + EDGE_MM * quick.edge_length, quick.shadow + EDGE_MM * quick.edge_shadow
        if self.lift <= self.limits.plate:
            low = (directions @ self.centre) - (self.outer_points @ directions.T).min(axis=0)
            held = np.where(self.tipping(directions) < FIRM_DEG, HOLD_MM2, 0.0)
            area, volume = area + held, volume + held * low
        return support_estimate(area, volume)

    def allows(self, directions: Floats) -> Bools:
        """Tell which directions ``(k, 3)`` the rules of the part allow."""
        allowed = directions[:, 2] >= np.cos(np.radians(min(self.tilt_deg, 180.0))) - 1e-9
        normals = self.surface.normals
        for mask, sign in ((self.faces.up, 1.0), (self.faces.down, -1.0)):
            looking = normals[mask & (self.surface.areas > 0.0)]
            if len(looking):
                allowed &= (sign * (looking @ directions.T)).min(axis=0) >= _FACING
        if self.faces.no_contact.any():
            allowed[allowed] = self._touched(directions[allowed]) <= _TOUCHED_MM2
        return np.asarray(allowed)

    def _touched(self, directions: Floats) -> Floats:
        """Return the area (mm2) of the faces that nothing may touch which need support or are on the plate."""
        apart_from_plate = self.limits._replace(plate=-1.0)
        spared = np.where(self.faces.no_contact, self.carried, 1.0)
        touched = quick_figures(
            self.surface, directions, apart_from_plate, lift=0.0, carried=spared, enforced=self.enforced
        )
        return touched.overhang


def turnable_part(part: Part, rules: SupportRules, lift: float, restricted: OrientationRules) -> TurnablePart:
    """Prepare a part for figures in many directions.

    Parameters
    ----------
    part
        The part with its own overhang angle, blockers and enforcers.
    rules
        Overhang angle and limits.
    lift
        Height (mm) of its lowest point above the plate.
    restricted
        What restricts its orientation.

    Raises
    ------
    JobError
        When the rules name faces that the part does not have.
    """
    own = part.overrides
    angle = rules.overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg
    ledge, bridge, bore = (
        (rules.ledge_mm, rules.bridge_mm, rules.bore_mm) if rules.has_limits else (0.0, 0.0, 0.0)
    )
    limits = Limits(angle, ledge, bridge, bore, rules.plate_mm, rules.layer_mm)
    modified = apply_regions(part.mesh, part.regions, np.eye(4))
    mesh, modifiers = modified.mesh, modified.modifiers
    surface = turnable_surface(mesh.vertices, mesh.triangles)
    if own.supports is False:
        carried = np.ones(len(surface.triangles))
    elif rules.has_limits:
        carried = carried_fractions(surface, limits)
    else:
        carried = np.zeros(len(surface.triangles))
    enforced = None
    if modifiers is not None:
        enforced = modifiers.enforced
        carried = np.where(enforced, 0.0, carried)
        carried = np.where(modifiers.blocked, 1.0, carried)
    return TurnablePart(
        surface,
        hull_of(surface.points),
        carried,
        enforced,
        limits,
        lift,
        face_masks(part, mesh, restricted),
        restricted.tilt_deg,
        centre_of_mass(surface.points[surface.triangles]),
    )


class TriedDirections(NamedTuple):
    """Directions ``(k, 3)`` that are allowed, with their quick figures and estimates ``(k,)`` of support."""

    directions: Floats
    figures: QuickFigures
    costs: Floats


def try_directions(part: TurnablePart) -> TriedDirections:
    """Return the directions that are tried: as drawn, flat faces, the smallest box, the sphere, and refined ones.

    The best of them are refined by steps that become smaller.
    """
    surface = part.surface
    found = [np.array([[0.0, 0.0, 1.0]])]
    if part.hull is not None:
        box = smallest_box_rotation(part.hull)[1]
        found += [box, -box, hull_directions(part.hull, _HULL_FACES)]
    cross = surface.normals * surface.areas[:, None]
    found += [np.eye(3), -np.eye(3), flat_face_directions(cross, _FLAT_FACES), sphere_directions(SPHERE)]
    first = _with_figures(part, distinct(np.concatenate(found)))
    if not len(first.directions):
        return first
    second = _with_figures(part, _refined(part, first))
    directions = np.concatenate([first.directions, second.directions])
    figures = (np.concatenate(pair) for pair in zip(first.figures, second.figures, strict=True))
    return TriedDirections(directions, QuickFigures(*figures), np.concatenate([first.costs, second.costs]))


def _with_figures(part: TurnablePart, directions: Floats) -> TriedDirections:
    """Return those of the directions that are allowed, with their figures."""
    allowed = directions[part.allows(directions)]
    figures = part.figures(allowed)
    return TriedDirections(allowed, figures, part.costs(allowed, figures))


def _refined(part: TurnablePart, found: TriedDirections) -> Floats:
    """Return the directions near the best ones that cost less than these."""
    directions, costs = found.directions, found.costs
    seeds = apart(ranked(costs).tolist(), directions, _SEEDS, 2.0 * _RINGS_DEG[0])
    best, least = directions[seeds], costs[seeds]
    for angle in _RINGS_DEG:
        tried = np.array([around(each, angle, _AROUND) for each in best])
        flat = tried.reshape(-1, 3)
        cost = np.where(part.allows(flat), part.costs(flat), np.inf).reshape(len(best), -1)
        first = cost.argmin(axis=1)
        rows = np.arange(len(best))
        better = cost[rows, first] < least
        best = np.where(better[:, None], tried[rows, first], best)
        least = np.where(better, cost[rows, first], least)
    return best[least < costs[seeds]]
