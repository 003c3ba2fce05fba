"""Pack the same shadows with the 2D nesting package spyrrow, for comparison."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.bench.measuring import measured
from amprep.bench.plates.run import PlatesResult, PlatesScene, judge_plates
from amprep.checks.packing.shadows import shadow_of
from amprep.errors import InputError
from amprep.model import Part, PlacedPart
from amprep.pipeline.packing import labels

if TYPE_CHECKING:
    from manifold3d import CrossSection

# Strategy. The package packs polygons without holes into a strip of given width, as short as possible. A plate is a
# strip of which the length may be the depth of the plate. Plates are filled one after another: parts are taken by
# decreasing area, up to a fraction of the area of the plate, and the greatest fraction whose strip is short enough is
# found by bisection. So each plate gets as many parts as the package can pack on it.

TRIALS = 6
"""Number of fractions that are tried for each plate."""

SMOOTHING = 0.02
"""Greatest distance (mm) by which the outlines given to the package may be outside the shadows."""


class PolygonItem(NamedTuple):
    """One copy of a part with the outer outline of its shadow ``(n, 2)`` mm, and its area, mm2."""

    part: int
    copy: int
    points: Floats
    area: float


class PlacedPolygon(NamedTuple):
    """An outline with its rotation about the origin, degrees, and the translation after it, mm."""

    outline: PolygonItem
    angle_deg: float
    shift: tuple[float, float]


def spyrrow_plates(scene: PlatesScene, *, seconds: float, seed: int) -> PlatesResult:
    """Pack a scene with spyrrow, and check every plate as polygons and on the meshes.

    Parameters
    ----------
    scene
        Parts that may only be rotated about the vertical axis; the plate is a rectangle.
    seconds
        Time for all plates together, about; each trial has at least one second.
    seed
        Seed of the package.

    Raises
    ------
    InputError
        If parts may be rotated otherwise, or the plate is round.
    """
    angles = [_angles(part) for part in scene.parts]
    if scene.space.shape != "box":
        raise InputError("spyrrow packs rectangular plates only; leave out --rivals")
    outlines = _outlines(scene)
    plate_area = float(np.prod(scene.space.size[:2]))
    expected = int(np.ceil(sum(each.area for each in outlines) / (0.75 * plate_area)))
    trial_seconds = max(1, int(seconds / (TRIALS * expected)))
    plates, spent = measured(lambda: _all_plates(outlines, scene, angles, trial_seconds, seed))
    judged, checked = measured(lambda: judge_plates(scene, [_placed_parts(scene, plate) for plate in plates]))
    return PlatesResult(
        packer="spyrrow",
        seed=seed,
        plates=len(plates),
        bound=None,
        bound_for="",
        filled=judged.filled,
        unplaced=len(outlines) - sum(len(plate) for plate in plates),
        check_seconds=checked.process_seconds,
        pairs=judged.pairs,
        faults=judged.faults,
        **spent._asdict(),
    )


def _all_plates(
    outlines: Sequence[PolygonItem],
    scene: PlatesScene,
    angles: Sequence[list[float] | None],
    seconds: int,
    seed: int,
) -> list[list[PlacedPolygon]]:
    """Return plates, filled one after another, until no outline is left that fits one."""
    fitting = [each for each in outlines if _fits_alone(each, scene, angles[each.part])]
    left, plates = sorted(fitting, key=lambda each: -each.area), []
    while left:
        placed = _fullest_plate(left, scene, angles, seconds, seed)
        if not placed:
            break
        plates.append(placed)
        taken = {(each.outline.part, each.outline.copy) for each in placed}
        left = [each for each in left if (each.part, each.copy) not in taken]
    return plates


def _fits_alone(item: PolygonItem, scene: PlatesScene, angles: list[float] | None) -> bool:
    """Return whether an outline fits the empty plate at one of its angles; the package panics at others."""
    room = scene.space.size[:2] - 2.0 * scene.clearance
    turns = np.deg2rad(np.arange(0.0, 180.0) if angles is None else angles)
    x, y = item.points.T
    wide = [(np.ptp(np.cos(t) * x - np.sin(t) * y), np.ptp(np.sin(t) * x + np.cos(t) * y)) for t in turns]
    return bool((np.array(wide) <= room).all(axis=1).any())


def _fullest_plate(
    left: Sequence[PolygonItem],
    scene: PlatesScene,
    angles: Sequence[list[float] | None],
    seconds: int,
    seed: int,
) -> list[PlacedPolygon]:
    """Return the plate with the greatest area of outlines that a bisection finds; empty if not even one fits."""
    plate_area = float(np.prod(scene.space.size[:2]))
    low, high, best = 0.0, min(1.0, sum(each.area for each in left) / plate_area), []
    fraction = high
    for _ in range(TRIALS):
        chosen = _chosen(left, fraction * plate_area)
        placed = _packed(chosen, scene, angles, seconds, seed)
        if placed:
            low, best = fraction, placed
            if len(chosen) == len(left):
                break
        else:
            high = fraction
        fraction = 0.5 * (low + high)
    return best or _packed(left[:1], scene, angles, seconds, seed)


def _chosen(left: Sequence[PolygonItem], area: float) -> list[PolygonItem]:
    """Return outlines of at most an area together, the greatest first; at least one."""
    chosen: list[PolygonItem] = []
    total = 0.0
    for each in left:
        if not chosen or total + each.area <= area * (1.0 + 1e-9):
            chosen.append(each)
            total += each.area
    return chosen


def _packed(
    chosen: Sequence[PolygonItem],
    scene: PlatesScene,
    angles: Sequence[list[float] | None],
    seconds: int,
    seed: int,
) -> list[PlacedPolygon]:
    """Return the outlines in a strip that is no longer than the plate; empty if the package finds none."""
    import spyrrow

    length, height = (float(side) for side in scene.space.size[:2])
    items = [
        spyrrow.Item(str(k), [tuple(point) for point in each.points], 1, angles[each.part])
        for k, each in enumerate(chosen)
    ]
    config = spyrrow.StripPackingConfig(
        early_termination=True,
        total_computation_time=seconds,
        num_workers=2,
        seed=seed,
        min_items_separation=scene.clearance or None,
    )
    found = spyrrow.StripPackingInstance("plate", height, items).solve(config)
    if found.width > length:
        return []
    return [_placed(chosen[int(each.id)], each) for each in found.placed_items]


def _placed(outline: PolygonItem, found: Any) -> PlacedPolygon:
    return PlacedPolygon(
        outline, float(found.rotation), (float(found.translation[0]), float(found.translation[1]))
    )


def _placed_parts(scene: PlatesScene, plate: Sequence[PlacedPolygon]) -> list[PlacedPart]:
    """Return the parts of a plate at their places, on the plate."""
    names, found = labels(scene.parts), []
    for outline, angle, shift in plate:
        part = scene.parts[outline.part]
        c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
        matrix = np.eye(4)
        matrix[:2, :2] = [[c, -s], [s, c]]
        matrix[:3, 3] = *shift, -part.mesh.bounds[0][2]
        found.append(PlacedPart(names[outline.part, outline.copy], part, matrix, part.orientations))
    return found


def _outlines(scene: PlatesScene) -> list[PolygonItem]:
    found = []
    for number, part in enumerate(scene.parts):
        points, area = outline_of(shadow_of(part, np.eye(3)))
        found += [PolygonItem(number, copy, points, area) for copy in range(part.quantity)]
    return found


def outline_of(shadow: "CrossSection") -> tuple[Floats, float]:
    """Return the outer contour of a shadow, enlarged a little so that few points suffice, and its area."""
    from manifold3d import JoinType

    parts = [_filled(piece) for piece in shadow.offset(0.5 * SMOOTHING, JoinType.Miter).decompose()]
    while len(parts) > 1:  # of several bodies: a narrow bridge makes one polygon of two
        one, other = parts.pop(), parts.pop()
        parts.append(_filled(one + other + _bridge(one, other)))
    whole = parts[0].simplify(0.5 * SMOOTHING)
    return np.asarray(whole.to_polygons()[0], np.float64), float(whole.area())


def _filled(piece: "CrossSection") -> "CrossSection":
    """Return a connected shadow without its holes: the greatest of its contours."""
    from manifold3d import CrossSection, FillRule

    contours = [CrossSection([contour], FillRule.Positive) for contour in piece.to_polygons()]
    return max(contours, key=lambda contour: float(contour.area()))


def _bridge(one: "CrossSection", other: "CrossSection") -> "CrossSection":
    """Return a narrow strip between the nearest points of two polygons."""
    from manifold3d import CrossSection

    a, b = (np.asarray(each.to_polygons()[0], np.float64) for each in (one, other))
    i, j = np.unravel_index(np.argmin(np.linalg.norm(a[:, None] - b[None], axis=2)), (len(a), len(b)))
    square = 0.5 * SMOOTHING * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return CrossSection.hull_points(np.vstack([a[i] + square, b[j] + square]))


def _angles(part: Part) -> list[float] | None:
    """Return the angles (degrees) by which a part may be rotated; None for any."""
    if part.orientations.freedom == "about-z":
        return None
    matrices = part.orientations.matrices
    if part.orientations.freedom == "free" or (matrices[:, 2, 2] < 1.0 - 1e-9).any():
        raise InputError(
            "spyrrow rotates about the vertical axis only; leave out --rivals or use --rotations z90"
        )
    return [float(np.rad2deg(np.arctan2(matrix[1, 0], matrix[0, 0]))) for matrix in matrices]
