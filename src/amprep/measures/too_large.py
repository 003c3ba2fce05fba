"""Prove that an item is too large for an empty build in every orientation that it allows."""

from collections.abc import Iterable

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.geometry.boxes.build_space import Space, find_feasible_position, rotated_boxes
from amprep.geometry.boxes.footprint import convex_outline, enclosing_radius, flush_angles
from amprep.measures.bounding_volume import points_of
from amprep.model.bounding_volume import Boxes
from amprep.model.packing import Item, PackingProblem

SLACK = 2.0 * CONTACT_TOLERANCE
"""Length (mm) by which an item may be larger than the room: contact at both walls may be penetrated."""

# Strategy. Of an item whose enclosing box or smallest circle is larger than the room it is proved in any orientation.
# Beside forbidden zones, an item can be too large although it is not in an empty build without them. That is proved
# only for boxes that stay parallel to the axes, for which the search for a position is exact.


def proved_too_large(problem: PackingProblem, items: Iterable[int]) -> set[int]:
    """Return those of some items that certainly fit no empty build; copies are judged once."""
    known: dict[tuple[int, int], bool] = {}
    found = set()
    for number in items:
        item = problem.items[number]
        key = id(item.volume), id(item.orientations)
        if key not in known:
            known[key] = _is_too_large(problem, item)
        if known[key]:
            found.add(number)
    return found


def _is_too_large(problem: PackingProblem, item: Item) -> bool:
    room = _room(problem)
    points, allowed = points_of(item.volume), item.orientations
    if allowed.freedom == "free":
        return bool(np.ptp(points, axis=0).max() > np.linalg.norm(np.maximum(room.hi - room.lo, 0.0)) + SLACK)
    if allowed.freedom == "about-z":
        return _exceeds_at_any_angle(points, room)
    return all(_exceeds(points @ r.T, room) or _excluded_by_zones(item, r, room) for r in allowed.matrices)


def _room(problem: PackingProblem) -> Space:
    """Return the space in which volumes may be in an empty build."""
    size, gap = problem.space.size, problem.clearance
    round_plate = problem.space.shape == "cylinder"
    return Space(
        np.array([gap, gap, problem.lift]),
        size - gap,
        size[:2] / 2.0,
        max(float(size[0]) / 2.0 - gap, 1e-9) if round_plate else 0.0,
        problem.space.zone_lo,
        problem.space.zone_hi,
        not problem.stacking,
        SLACK,
    )


def _exceeds(points: Floats, room: Space) -> bool:
    """Return whether the enclosing box of points is larger than the room, or their smallest circle than its circle."""
    if (np.ptp(points, axis=0) > room.hi - room.lo + SLACK).any():
        return True
    return bool(room.radius) and enclosing_radius(convex_outline(points[:, :2])) > room.radius + SLACK


def _exceeds_at_any_angle(points: Floats, room: Space) -> bool:
    """Return whether points are too high, or their footprint at any angle is wider than the narrower side."""
    side = room.hi - room.lo
    if np.ptp(points[:, 2]) > side[2] + SLACK:
        return True
    outline = convex_outline(points[:, :2])
    if room.radius:
        return bool(enclosing_radius(outline) > room.radius + SLACK)
    angles = np.concatenate((flush_angles(outline), flush_angles(outline) + np.pi / 2.0))
    along = np.array([np.cos(angles), -np.sin(angles)])
    width = np.ptp(outline @ along, axis=0).min(initial=np.inf)
    return bool(np.isfinite(width) and width > side[:2].min() + SLACK)


def _excluded_by_zones(item: Item, rotation: Floats, room: Space) -> bool:
    """Return whether boxes that stay parallel to the axes have no position beside the forbidden zones."""
    turned = np.abs(rotation)
    if not isinstance(item.volume, Boxes) or (np.minimum(turned, np.abs(1.0 - turned)) > 1e-9).any():
        return False
    lo, hi = rotated_boxes(item.volume.lo, item.volume.hi, rotation)
    return find_feasible_position(lo, hi, room) is None
