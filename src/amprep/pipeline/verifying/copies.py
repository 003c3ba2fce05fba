"""Find equal copies of parts with equal supports, of which one stands for the others before the judges of supports."""

from collections.abc import Mapping, Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.model import Build, BuildVolume, PlacedPart, SupportBody, Unsupported
from amprep.pipeline.verifying.nearby import are_near, boxes_in_plan, distance_that_matters

TOLERANCE = 1e-4
"""Largest difference (mm) of coordinates of equal copies: files keep them as float32, the judges grant more."""

# Strategy. Whoever made the file is not asked: geometry is compared. A part is like another one if its mesh, rotation,
# height and exceptions are the same, its supports and listed regions are those of the other one after the same
# translation, and no other part meets the box around them. The places of all parts and the distances of all supports
# are judged in any case, so what remains depends on nothing but what was compared. Neighbours and borders are reasons
# for listed regions, so parts with some count as copies only where both are far away.


def find_copies(build: Build) -> dict[int, int]:
    """Return for each part that is like another one, with its supports, the index of that one."""
    bodies, regions = _own_bodies(build), _own_regions(build)
    first: dict[tuple[object, ...], list[int]] = {}
    like: dict[int, int] = {}
    for number in _far_from_others(build, bodies):
        own, listed = bodies[number], regions.get(number, [])
        if not _is_inside(build, own) or (listed and not _is_open_around(build, number)):
            continue
        candidates = first.setdefault(_key(build.parts[number]), [])
        for other in candidates:
            shift = (build.parts[number].matrix - build.parts[other].matrix)[:3, 3]
            if _are_moved(own, bodies[other], shift) and _are_moved_regions(
                listed, regions.get(other, []), shift
            ):
                like[number] = other
                break
        else:
            candidates.append(number)
    return like


def _key(placed: PlacedPart) -> tuple[object, ...]:
    """Return what equal copies have in common: geometry, regions, exceptions, rotation and height."""
    part, matrix = placed.part, placed.matrix
    painted = id(part) if part.regions else None
    return part.mesh.digest, painted, part.overrides, matrix[:3, :3].tobytes(), float(matrix[2, 3])


def _far_from_others(build: Build, bodies: Mapping[int, Sequence[SupportBody]]) -> list[int]:
    """Return the parts whose supports no other part is near, so that it matters to no judge of these supports."""
    parts = boxes_in_plan(build.parts)
    near = build.settings.rules.gap_mm + TOLERANCE
    found = []
    for number, own in bodies.items():
        corners = [
            parts[number],
            *(np.array(body.mesh.bounds)[:, :2] for body in own if len(body.mesh.vertices)),
        ]
        box = np.array([np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))])
        if are_near(parts, box, near).sum() == 1:
            found.append(number)
    return found


def _own_bodies(build: Build) -> dict[int, list[SupportBody]]:
    """Return the supports of each part; none for parts that share supports or have beams."""
    bodies: dict[int, list[SupportBody]] = {number: [] for number in range(len(build.parts))}
    excluded: set[int] = set()
    for body in build.supports:
        if len(body.parts) == 1 and body.lattice is None:
            bodies[body.parts[0]].append(body)
        else:
            excluded.update(body.parts)
    return {number: own for number, own in bodies.items() if number not in excluded}


def _own_regions(build: Build) -> dict[int, list[Unsupported]]:
    """Return the listed regions of each part that has some."""
    regions: dict[int, list[Unsupported]] = {}
    for region in build.unsupported:
        regions.setdefault(region.part, []).append(region)
    return regions


def _are_moved(own: Sequence[SupportBody], others: Sequence[SupportBody], shift: Floats) -> bool:
    """Tell whether supports are those of another part, moved."""
    return len(own) == len(others) and all(
        (body.surface, body.reach, body.sizes) == (other.surface, other.reach, other.sizes)
        and np.array_equal(body.mesh.triangles, other.mesh.triangles)
        and _is_moved(body.mesh.vertices, other.mesh.vertices, shift)
        for body, other in zip(own, others, strict=True)
    )


def _are_moved_regions(own: Sequence[Unsupported], others: Sequence[Unsupported], shift: Floats) -> bool:
    """Tell whether listed regions are those of another part, moved."""
    return len(own) == len(others) and all(
        (region.kind, region.reason, region.radius, region.minor)
        == (other.kind, other.reason, other.radius, other.minor)
        and _is_moved(region.points, other.points, shift)
        for region, other in zip(own, others, strict=True)
    )


def _is_moved(points: Floats, others: Floats, shift: Floats) -> bool:
    if points.shape != others.shape:
        return False
    return bool((np.abs(points - others - shift) <= TOLERANCE).all())


def _is_inside(build: Build, own: Sequence[SupportBody]) -> bool:
    """Tell whether boxes around supports are inside the build volume, so that its border does not matter to them."""
    boxes = [body.mesh.bounds for body in own if len(body.mesh.vertices)]
    return all(_holds(build.settings.space, low, high) for low, high in boxes)


def _is_open_around(build: Build, number: int) -> bool:
    """Tell whether neither a border nor another part is near enough to be the reason for a listed region of a part."""
    boxes = boxes_in_plan(build.parts)
    distance = distance_that_matters(build.settings, build.parts)
    if are_near(boxes, boxes[number], distance).sum() > 1:
        return False
    (low, high), around = build.parts[number].mesh.bounds, np.array([distance, distance, 0.0])
    return _holds(build.settings.space, low - around, high + around)


def _holds(space: BuildVolume, low: Floats, high: Floats) -> bool:
    """Tell whether a box is inside the build volume and outside its zones."""
    if (low < -TOLERANCE).any() or (high > space.size + TOLERANCE).any():
        return False
    if ((space.zone_lo < high) & (space.zone_hi > low)).all(axis=1).any():
        return False
    radius = space.size[0] / 2.0
    farthest = np.hypot(*np.maximum(np.abs(low[:2] - radius), np.abs(high[:2] - radius)))
    return space.shape == "box" or bool(farthest <= radius)
