"""Prepare a packing problem as arrays, once for all packers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s
from amprep.errors import AmprepError
from amprep.geometry.boxes.build_space import Space, find_feasible_position, rotated_boxes
from amprep.kernels.boxes.records import PAIR_SLACK, BoxInstance
from amprep.measures.bounding_volume import points_of
from amprep.model.bounding_volume import BoundingVolume, Boxes
from amprep.model.packing import Item, Objective, PackingProblem, require_values

BoxesAt = Callable[[BoundingVolume, Floats], tuple[Floats, Floats]]
"""Function of a volume and a rotation ``(3, 3)`` that returns corners of boxes, each ``(k, 3)`` mm."""

SAME = 1e-8
"""Difference (mm) up to which the boxes of two orientations count as equal."""


@dataclass(frozen=True, eq=False)
class Orientation:
    """A bounding volume in one orientation: boxes ``(k, 3)`` mm relative to their least corner, without clearance.

    Attributes
    ----------
    rotation
        ``(3, 3)``.
    shift
        ``(3,)`` mm from the least corner to the origin of the turned volume.
    feasible_position
        ``(3,)`` mm a position of the least corner in an empty build; NaN when there is none.
    """

    rotation: Floats
    lo: Floats
    hi: Floats
    shift: Floats
    feasible_position: Floats

    @cached_property
    def size(self) -> Floats:
        """The enclosing box, ``(3,)`` mm."""
        return np.asarray(self.hi.max(axis=0))

    @property
    def fits(self) -> bool:
        """Whether it has a position in an empty build."""
        return bool(np.isfinite(self.feasible_position[0]))


ItemType = tuple[Orientation, ...]
"""The different orientations of items with the same bounding volume and the same allowed rotations."""


@dataclass(frozen=True, eq=False)
class PreparedInstance:
    """A packing problem prepared for box packers.

    Attributes
    ----------
    type_of
        ``(n,)`` int64 type of each item.
    free
        ``(n,)`` bool: items to be placed, which are neither fixed nor too large.
    too_large
        ``(n,)`` bool: items without a position in an empty build.
    fixed_lo, fixed_hi
        ``(m, 3)`` mm boxes of the fixed placements, without clearance.
    """

    problem: PackingProblem
    space: Space
    type_of: Int64s
    types: tuple[ItemType, ...]
    free: Bools
    too_large: Bools
    fixed_lo: Floats
    fixed_hi: Floats

    @cached_property
    def orientations(self) -> ItemType:
        """The orientations of all types, which `Arrangement.orientation` counts."""
        return tuple(orientation for item_type in self.types for orientation in item_type)

    @cached_property
    def first_orientation(self) -> Int64s:
        """Index of the first orientation of each type, ``(types + 1,)``."""
        return _starts([len(item_type) for item_type in self.types])

    @cached_property
    def boxes(self) -> BoxInstance:
        """The instance as the kernels read it, with clearance in the data."""
        gap, orientations = self.problem.clearance, self.orientations
        return BoxInstance(
            type_of=self.type_of,
            first_orientation=self.first_orientation,
            first_box=_starts([len(orientation.lo) for orientation in orientations]),
            orientations=np.array([[*(o.size + gap), *o.feasible_position] for o in orientations]).reshape(
                -1, 6
            ),
            boxes=np.array(
                [[*lo, *(hi + gap)] for o in orientations for lo, hi in zip(o.lo, o.hi, strict=True)]
            ).reshape(-1, 6),
            room=_room(self),
            obstacles=_obstacles(self),
            zones=len(self.space.zone_lo),
        )

    @property
    def filling(self) -> bool:
        """Whether one build is filled with the greatest value; else few builds are wanted."""
        return self.problem.objective == "fill"

    @property
    def in_one_build(self) -> bool:
        """Whether there is one build: it is filled, or has to be low."""
        return self.problem.objective != "builds"

    @property
    def demand(self) -> Int64s:
        """Number of free items of each type, ``(types,)``."""
        return np.bincount(self.type_of[self.free], minlength=len(self.types))


def prepare(problem: PackingProblem, *, enclosing: bool = False) -> PreparedInstance:
    """Return the problem as arrays.

    Parameters
    ----------
    problem
        The problem.
    enclosing
        Whether volumes that are no boxes are packed as their enclosing boxes, in each orientation its own.

    Raises
    ------
    AmprepError
        If a volume is not made of boxes and `enclosing` is false, or a value is negative or not finite.
    """
    require_values(problem)
    if enclosing:
        problem = replace(problem, items=tuple(replace(item, exact=False) for item in problem.items))
    boxes_at = enclosing_box_at if enclosing else boxes_of_at
    space = empty_space(problem)
    known: dict[tuple[bytes, ...], int] = {}
    types: list[ItemType] = []
    type_of = np.empty(len(problem.items), dtype=np.int64)
    for i, item in enumerate(problem.items):
        key = (*_content(item.volume, enclosing), _rotations(item).tobytes())
        if key not in known:
            known[key] = len(types)
            types.append(
                _orientations([boxes_at(item.volume, r) for r in _rotations(item)], _rotations(item), space)
            )
        type_of[i] = known[key]
    fits = np.array([any(o.fits for o in item_type) for item_type in types], dtype=bool)[type_of]
    free = np.ones(len(type_of), dtype=bool)
    free[[placement.item for placement in problem.fixed]] = False
    fixed = _fixed_boxes(problem, boxes_at)
    return PreparedInstance(problem, space, type_of, tuple(types), free & fits, free & ~fits, *fixed)


def restrict(
    instance: PreparedInstance, items: Int64s, objective: Objective, values: Floats | None = None
) -> PreparedInstance:
    """Return the instance of some free items alone, without anything fixed.

    Parameters
    ----------
    items
        ``(m,)`` items to be kept; they become the items 0 to m - 1.
    values
        ``(types,)`` new values of the items by their type; None keeps the old ones.
    """
    kept = [instance.problem.items[item] for item in items.tolist()]
    if values is not None:
        new = values[instance.type_of[items]].tolist()
        kept = [replace(item, value=value) for item, value in zip(kept, new, strict=True)]
    numbers: dict[int, int] = {}
    type_of = [numbers.setdefault(old, len(numbers)) for old in instance.type_of[items].tolist()]
    return PreparedInstance(
        replace(instance.problem, items=tuple(kept), objective=objective, fixed=()),
        instance.space,
        np.array(type_of, np.int64),
        tuple(instance.types[old] for old in numbers),
        np.ones(len(items), dtype=bool),
        np.zeros(len(items), dtype=bool),
        np.empty((0, 3)),
        np.empty((0, 3)),
    )


def empty_space(problem: PackingProblem) -> Space:
    """Return the space in which boxes without clearance may be in an empty build."""
    size, gap = problem.space.size, problem.clearance
    return Space(
        lo=np.array([gap, gap, problem.lift]),
        hi=size - gap,
        axis=size[:2] / 2.0,
        radius=max(float(size[0]) / 2.0 - gap, 1e-9) if problem.space.shape == "cylinder" else 0.0,
        zone_lo=problem.space.zone_lo,
        zone_hi=problem.space.zone_hi,
        flat=not problem.stacking,
        slack=CONTACT_TOLERANCE + 1e-9,  # rounding must not decide whether a box just fits
    )


def boxes_of(volume: BoundingVolume) -> Boxes:
    """Return the volume when it is made of boxes.

    Raises
    ------
    AmprepError
        If it is another volume: the host lets none through that a packer does not accept.
    """
    if isinstance(volume, Boxes):
        return volume
    raise AmprepError(
        f"this packer packs boxes, got {type(volume).__name__}; choose the volume maker 'box' or 'boxes'"
    )


def boxes_of_at(volume: BoundingVolume, rotation: Floats) -> tuple[Floats, Floats]:
    """Return corners ``(k, 3)`` mm of the boxes of a volume after a rotation; see `boxes_of`."""
    boxes = boxes_of(volume)
    return rotated_boxes(boxes.lo, boxes.hi, rotation)


def enclosing_box_at(volume: BoundingVolume, rotation: Floats) -> tuple[Floats, Floats]:
    """Return corners ``(k, 3)`` mm of the boxes, or of the enclosing box of another volume, after a rotation."""
    if isinstance(volume, Boxes):
        return rotated_boxes(volume.lo, volume.hi, rotation)
    points = points_of(volume) @ rotation.T
    return points.min(axis=0)[None], points.max(axis=0)[None]


def _content(volume: BoundingVolume, enclosing: bool) -> tuple[bytes, ...]:
    """Return what equal volumes have in common."""
    if enclosing and not isinstance(volume, Boxes):
        return (str(id(volume)).encode(),)
    boxes = boxes_of(volume)
    return boxes.lo.tobytes(), boxes.hi.tobytes()


def _rotations(item: Item) -> Floats:
    """Return the allowed rotations ``(k, 3, 3)``; for a continuous freedom the present orientation alone."""
    return item.orientations.matrices if item.orientations.freedom == "list" else np.eye(3)[None]


def _orientations(turned: Sequence[tuple[Floats, Floats]], rotations: Floats, space: Space) -> ItemType:
    """Return one orientation for each rotation that gives different boxes, from the corners after each rotation."""
    found: list[Orientation] = []
    seen: set[bytes] = set()
    for rotation, (low, high) in zip(rotations, turned, strict=True):
        least = low.min(axis=0)
        lo, hi = low - least, high - least
        key = np.round(np.concatenate((lo, hi)) / SAME).astype(np.int64).tobytes()
        if key in seen:
            continue
        seen.add(key)
        position = find_feasible_position(lo, hi, space)
        found.append(
            Orientation(rotation, lo, hi, -least, np.full(3, np.nan) if position is None else position)
        )
    return tuple(found)


def _fixed_boxes(problem: PackingProblem, boxes_at: BoxesAt) -> tuple[Floats, Floats]:
    """Return the boxes of the fixed placements in build coordinates, each ``(m, 3)`` mm."""
    corners = [np.empty((0, 3))], [np.empty((0, 3))]
    for placement in problem.fixed:
        boxes = boxes_at(problem.items[placement.item].volume, placement.rotation)
        for side, corner in zip(corners, boxes, strict=True):
            side.append(corner + placement.translation)
    return np.concatenate(corners[0]), np.concatenate(corners[1])


def _starts(lengths: Sequence[int]) -> Int64s:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)


def _room(instance: PreparedInstance) -> Floats:
    """Return the room of the kernels: items are longer by the clearance, so the upper walls are moved by it."""
    space, gap = instance.space, instance.problem.clearance
    corners, rules = (*space.lo, *(space.hi + gap)), (gap, space.slack, float(space.flat))
    return np.array([*corners, *space.axis, space.radius, *rules, *_least_space(instance)])


def _least_space(instance: PreparedInstance) -> Floats:
    """Return the least residual space of a useful point, ``(3,)`` mm; with items of several boxes any is useful."""
    orientations = instance.orientations
    if not orientations or any(len(orientation.lo) > 1 for orientation in orientations):
        return np.full(3, PAIR_SLACK)
    least = np.min([orientation.size for orientation in orientations], axis=0)
    return np.asarray(np.maximum(least + instance.problem.clearance - instance.space.slack, PAIR_SLACK))


def _obstacles(instance: PreparedInstance) -> Floats:
    """Return forbidden zones and fixed boxes ``(m, 6)`` mm.

    Zones need no clearance: their lower sides are moved up by it, which cancels the clearance of the items.
    """
    gap = instance.problem.clearance
    zones = np.hstack((instance.space.zone_lo + gap, instance.space.zone_hi))
    return np.concatenate((zones, np.hstack((instance.fixed_lo, instance.fixed_hi + gap))))
