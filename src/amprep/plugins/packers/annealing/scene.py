"""The scene of an annealing: bodies with shapes, weights, orientations and berths, and the build volume."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Floats
from amprep.model.bounding_volume import BoundingVolume, Boxes
from amprep.model.packing import PackingProblem, Placement
from amprep.plugins.packers.annealing.shapes import choose_engine, make_shapes, points_of
from amprep.plugins.packers.annealing.start import listed

if TYPE_CHECKING:
    from amprep.kernels.annealing.records import AnnealingScene

FREEDOMS = {"list": 0, "about-z": 1, "free": 2}


@dataclass(frozen=True, eq=False)
class PreparedVolumes:
    """The volumes of a problem and of its forbidden zones, prepared once for all builds.

    Attributes
    ----------
    problem
        The packing problem.
    shape_of
        ``(n,)`` shape of each item, then of each zone.
    points
        For each shape, points ``(k, 3)`` whose convex hull is that of the shape, mm.
    volumes
        The volume of each shape.
    engine
        The collision engine.
    """

    problem: PackingProblem
    shape_of: tuple[int, ...]
    points: tuple[Floats, ...]
    volumes: tuple[BoundingVolume, ...]
    engine: str

    @cached_property
    def shapes(self) -> Any:
        """The shapes for the collision queries, made when they are first needed."""
        turning = any(item.orientations.freedom != "list" for item in self.problem.items)
        return make_shapes(self.volumes, self.engine, turning=turning)


def prepare_volumes(problem: PackingProblem, collision: str) -> PreparedVolumes:
    """Return the volumes of the items and of the zones as shapes; copies of a part share one."""
    engine = choose_engine(problem, collision)
    zones = _zones(problem)
    volumes: list[BoundingVolume] = []
    known: dict[int, int] = {}
    for volume in (*(item.volume for item in problem.items), *zones):
        if id(volume) not in known:
            known[id(volume)] = len(volumes)
            volumes.append(volume)
    shape_of = tuple(known[id(volume)] for volume in (*(item.volume for item in problem.items), *zones))
    points = tuple(points_of(volume) for volume in volumes)
    return PreparedVolumes(problem, shape_of, points, tuple(volumes), engine)


def _zones(problem: PackingProblem) -> list[Boxes]:
    """Return what the forbidden zones have in common with the box of the build volume; berths are outside of it."""
    lo = np.maximum(problem.space.zone_lo, 0.0)
    hi = np.minimum(problem.space.zone_hi, problem.space.size)
    return [Boxes(*corners) for corners in zip(lo, hi, strict=True) if (corners[1] > corners[0]).all()]


def fits_by_size(prepared: PreparedVolumes, item: int) -> bool:
    """Return whether the enclosing box of an item fits the build volume in an allowed orientation.

    Items that may be turned by any angle always count as fitting.
    """
    problem = prepared.problem
    if problem.items[item].orientations.freedom != "list":
        return True
    low, high = inner_corners(problem)
    points = prepared.points[prepared.shape_of[item]]
    turned = np.einsum("rij,nj->rni", problem.items[item].orientations.matrices, points)
    return bool((np.ptp(turned, axis=1) <= high - low + 2e-3).all(axis=1).any())


def inner_corners(problem: PackingProblem) -> tuple[Floats, Floats]:
    """Return the corners of the region for bodies: the build volume without the clearance and the lift."""
    gap = problem.clearance
    return np.array([gap, gap, problem.lift]), problem.space.size - gap


def make_scene(
    prepared: PreparedVolumes,
    movable: Sequence[int],
    fixed: Sequence[Placement],
    weights: Floats,
    masses: Floats,
) -> tuple["AnnealingScene", Floats]:
    """Return the scene of one build, and the poses ``(m, 12)`` of its bodies, the movable ones at their berths.

    Parameters
    ----------
    prepared
        The volumes.
    movable
        Items that may move.
    fixed
        Placements of items that stay.
    weights, masses
        ``(movable,)``; see `AnnealingScene`.
    """
    from amprep.kernels.annealing.records import AnnealingScene

    problem, count = prepared.problem, len(prepared.problem.items)
    bodies = [*movable, *(p.item for p in fixed), *range(count, len(prepared.shape_of))]
    still = np.zeros(len(bodies) - len(movable))
    low, high = inner_corners(problem)
    turns = [_turns(problem, body) for body in bodies]
    berth, hall_high = _berths(prepared, movable, turns, low, high)
    reach = float(np.max(hall_high - low, initial=0.0))
    scene = AnnealingScene(
        shape_of=np.array([prepared.shape_of[body] for body in bodies], np.int64),
        points=np.concatenate(prepared.points) if prepared.points else np.empty((0, 3)),
        first_point=_starts([len(p) for p in prepared.points]),
        weight=np.concatenate((weights, still)),
        mass=np.concatenate((masses, still)),
        margin=np.array([problem.clearance if body < count else 0.0 for body in bodies]),
        freedom=np.array([_freedom(problem, body) for body in bodies], np.int64),
        first_turn=_starts([len(t) for t in turns]),
        turns=np.concatenate([t.reshape(-1, 9) for t in turns]) if turns else np.empty((0, 9)),
        berth=berth,
        low=low,
        high=high,
        radius=max(float(problem.space.size[0]) / 2.0 - problem.clearance, 1e-9)
        if problem.space.shape == "cylinder"
        else 0.0,
        hall_low=low - 0.5 * reach,
        hall_high=hall_high + 0.5 * reach,
        is_flat=not problem.stacking,
    )
    poses = [*berth, *(_pose(p.rotation, p.translation) for p in fixed)]
    poses += [_pose(np.eye(3), np.zeros(3))] * (len(bodies) - len(poses))
    return scene, np.array(poses).reshape(-1, 12)


def place(poses: Floats, movable: Sequence[int], placed: Mapping[int, Placement]) -> None:
    """Write the poses of placed items to the first rows of `poses`."""
    for row, item in enumerate(movable):
        if item in placed:
            poses[row] = _pose(placed[item].rotation, placed[item].translation)


def _pose(rotation: Floats, translation: Floats) -> Floats:
    return np.column_stack((rotation, translation)).ravel()


def _turns(problem: PackingProblem, body: int) -> Floats:
    if body >= len(problem.items):
        return np.eye(3)[None]
    return listed(problem.items[body].orientations).matrices


def _freedom(problem: PackingProblem, body: int) -> int:
    return FREEDOMS[problem.items[body].orientations.freedom] if body < len(problem.items) else 0


def _berths(
    prepared: PreparedVolumes, movable: Sequence[int], turns: Sequence[Floats], low: Floats, high: Floats
) -> tuple[Floats, Floats]:
    """Return a pose ``(movable, 12)`` for each item beside the build volume, and the upper corner around all.

    The berths are squares of a grid on the positive side of x.
    """
    boxes = [
        (points.min(axis=0), points.max(axis=0))
        for item, rotations in zip(movable, turns, strict=False)
        for points in (prepared.points[prepared.shape_of[item]] @ rotations[0].T,)
    ]
    sizes = np.array([hi - lo for lo, hi in boxes]).reshape(-1, 3)
    gap = prepared.problem.clearance + 1.0
    cell = sizes.max(axis=0, initial=0.0) + gap
    across = int(np.ceil(np.sqrt(len(boxes))))
    berth = np.empty((len(boxes), 12))
    for row, (lo, _) in enumerate(boxes):
        corner = np.array(
            [high[0] + gap + (row // across) * cell[0], low[1] + (row % across) * cell[1], low[2]]
        )
        berth[row] = _pose(turns[row][0], corner - lo)
    far = np.array([high[0] + gap + across * cell[0], low[1] + across * cell[1], low[2] + cell[2]])
    return berth, np.maximum(high, far)


def _starts(lengths: Sequence[int]) -> Any:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)
