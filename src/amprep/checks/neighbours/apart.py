"""Judge supports beside each other and beside parts that they do not hold.

Two supports that hold no part together must not overlap. Beside another part, a support keeps the clearance of the
parts less the margin of its territory, because that is how far it may leave the shadow of its own part. Where parts are
nearer to each other in plan than that, or territories are shared, only penetration and the XY distance are judged, by
other judges.
"""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.supports.territory import TOLERANCE as BORDER_TOLERANCE
from amprep.checks.supports.territory import margin_of
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.distance import near_pairs, thickness, triangle_distance
from amprep.geometry.meshes.manifold import accepted
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

APART = "supports enter no other support"
NEIGHBOURS = "distance to other parts"
PROMISES = (APART, NEIGHBOURS)
"""Names of the promises."""

Box = tuple[Floats, Floats]


def check_apart(build: Build, stop: Stop, solids: KnownSolids | None = None) -> list[Violation]:
    """Return the supports that enter supports of other parts, or come too near to other parts.

    Walls without thickness are judged beside parts only; beams are judged as the solids that stand in for them.
    `solids` are shared with other judges.
    """
    solids = solids or KnownSolids()
    found: list[Violation] = []
    bodies = [body for body in build.supports if not body.surface]
    boxes = [body.mesh.bounds for body in bodies]
    low, high = (np.array([box[side] for box in boxes]).reshape(-1, 3) for side in (0, 1))
    for i, j in near_pairs(low, high, -TOLERANCE):
        if stop():
            return found
        if not set(bodies[i].parts) & set(bodies[j].parts):
            found += _overlap(bodies[i], bodies[j], solids)
    return found + _too_near_others(build, stop)


def extent_of(build: Build, not_judged: str) -> str:
    """Return which distance to other parts was judged; it begins with `not_judged` if none was."""
    if build.settings.rules.territory != "own":
        return f"{not_judged}: territories are shared"
    return f"clearance less the margin of the territory, tolerance {BORDER_TOLERANCE:g} mm"


def _overlap(one: SupportBody, other: SupportBody, solids: KnownSolids) -> list[Violation]:
    first, second = solids.of(one.mesh), solids.of(other.mesh)
    if not (accepted(first) and accepted(second)):
        return []
    common = first ^ second
    if thickness(common) <= TOLERANCE:
        return []
    place = place_words(np.array(common.bounding_box()[:3]))
    message = f"enters {other.name}: {common.volume():.3g} mm3 from {place} mm are in both"
    return [Violation(APART, one.name, message)]


def _too_near_others(build: Build, stop: Stop) -> list[Violation]:
    found: list[Violation] = []
    if build.settings.rules.territory != "own" or not build.supports:
        return found
    meshes = [placed.mesh for placed in build.parts]
    boxes = [mesh.bounds for mesh in meshes]
    low, high = (np.array([box[side] for box in boxes]).reshape(-1, 3) for side in (0, 1))
    most = max((_clearance(build, index) for index in range(len(boxes))), default=0.0)
    for body in build.supports:
        least_corner, greatest_corner = body.mesh.bounds
        # no distance that is granted is more than the greatest clearance
        near = ((low <= greatest_corner + most) & (high >= least_corner - most)).all(axis=1)
        for index in np.flatnonzero(near).tolist():
            if stop():
                return found
            if index not in body.parts:
                least = _granted(build, body, index, boxes) - BORDER_TOLERANCE
                if least > CONTACT_TOLERANCE:
                    found += _too_near(body, build.parts[index], meshes[index], least)
    return found


def _granted(build: Build, body: SupportBody, other: int, boxes: Sequence[Box]) -> float:
    """Return the distance (mm) that a support keeps from a part that it does not hold.

    The distance of the bounding boxes of the parts in plan, up to the clearance, less the margin of the territory.
    """
    return min(
        min(_clearance(build, held, other), _distance_in_plan(boxes[held], boxes[other]))
        - margin_of(build, held)
        for held in body.parts
    )


def _clearance(build: Build, *parts: int) -> float:
    """Return the greater clearance (mm) of two parts."""
    own = [build.parts[part].part.overrides.clearance_mm for part in parts]
    return max(build.settings.clearance if each is None else each for each in own)


def _distance_in_plan(one: Box, other: Box) -> float:
    gap = np.maximum(one[0] - other[1], other[0] - one[1])[:2]
    return float(np.hypot(*np.maximum(gap, 0.0)))


def _too_near(body: SupportBody, placed: PlacedPart, mesh: Mesh, least: float) -> list[Violation]:
    own = _triangles_near(body.mesh, mesh.bounds, least)
    if not len(own):
        return []
    others = _triangles_near(mesh, body.mesh.bounds, least)
    distance = triangle_distance(own, others, least) if len(others) else least
    if distance >= least:
        return []
    message = (
        f"is {max(distance, 0.0):.4g} mm from {placed.label}, which it does not hold, expected at least "
        f"{least:.4g} mm: the clearance less the margin of the territory"
    )
    return [Violation(NEIGHBOURS, body.name, message)]


def _triangles_near(mesh: Mesh, box: Box, distance: float) -> Floats:
    """Return the corners ``(k, 3, 3)`` of the triangles that come within a distance of a box along each axis."""
    low, high = mesh.bounds
    if (low > box[1] + distance).any() or (high < box[0] - distance).any():
        return np.empty((0, 3, 3))
    corners = mesh.vertices[mesh.triangles]
    near = (corners.min(axis=1) <= box[1] + distance) & (corners.max(axis=1) >= box[0] - distance)
    return np.asarray(corners[near.all(axis=1)])
