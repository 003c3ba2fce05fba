"""A packing problem as flat arrays: volumes in each orientation, the room, what stands in it already."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s
from amprep.errors import AmprepError
from amprep.geometry.boxes.build_space import Space, find_home, rotated_boxes
from amprep.model.bounding_volume import BoundingVolume, Boxes
from amprep.model.packing import Item, PackingProblem, Placement

SAME = 1e-8
"""mm by which the boxes of two orientations may differ to count as one."""


@dataclass(frozen=True, eq=False)
class Variant:
    """A volume in one orientation: boxes ``(k, 3)`` relative to their least corner, without clearance.

    Attributes
    ----------
    shift
        ``(3,)`` from the least corner to the turned volume's origin.
    home
        ``(3,)`` a place of the least corner in an empty build; NaN when there is none.
    """

    rotation: Floats
    lo: Floats
    hi: Floats
    shift: Floats
    home: Floats

    @cached_property
    def size(self) -> Floats:
        """The enclosing box, ``(3,)`` mm."""
        return np.asarray(self.hi.max(axis=0))


@dataclass(frozen=True, eq=False)
class Scene:
    """A problem prepared for packing.

    Attributes
    ----------
    kind
        ``(n,)`` int64 kind of each item; items of a kind share volume and orientations.
    kinds
        The variants of each kind.
    free
        ``(n,)`` bool: items to be placed, that is not fixed and not too large.
    too_large
        ``(n,)`` bool: items that fit no empty build.
    standing_lo, standing_hi
        ``(m, 3)`` boxes of the fixed placements, without clearance.
    """

    problem: PackingProblem
    space: Space
    kind: Int64s
    kinds: tuple[tuple[Variant, ...], ...]
    free: Bools
    too_large: Bools
    standing_lo: Floats
    standing_hi: Floats


def empty_space(problem: PackingProblem) -> Space:
    """Return where boxes without clearance may be in an empty build."""
    size, gap = problem.space.size, problem.clearance
    return Space(
        lo=np.array([gap, gap, problem.lift]),
        hi=size - gap,
        axis=size[:2] / 2.0,
        radius=max(float(size[0]) / 2.0 - gap, 1e-9) if problem.space.shape == "cylinder" else 0.0,
        zone_lo=problem.space.zone_lo,
        zone_hi=problem.space.zone_hi,
        flat=not problem.stacking,
        slack=CONTACT_TOLERANCE + 1e-9,  # rounding does not decide what just fits
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


def prepare(problem: PackingProblem) -> Scene:
    """Return the problem as arrays.

    Raises
    ------
    AmprepError
        If a volume is not of boxes, or a value is negative.
    """
    for item in problem.items:
        if not item.value >= 0.0:
            raise AmprepError(f"part {item.part}: its value must be at least 0, got {item.value:g}")
    space = empty_space(problem)
    known: dict[tuple[bytes, ...], int] = {}
    kinds: list[tuple[Variant, ...]] = []
    kind = np.empty(len(problem.items), dtype=np.int64)
    for i, item in enumerate(problem.items):
        boxes = boxes_of(item.volume)
        key = (boxes.lo.tobytes(), boxes.hi.tobytes(), _rotations(item).tobytes())
        if key not in known:
            known[key] = len(kinds)
            kinds.append(_variants(boxes, _rotations(item), space))
        kind[i] = known[key]
    fits = np.array([any(np.isfinite(v.home[0]) for v in variants) for variants in kinds], dtype=bool)[kind]
    free = np.ones(len(kind), dtype=bool)
    free[[placement.item for placement in problem.fixed]] = False
    standing_lo, standing_hi = _standing(problem)
    return Scene(problem, space, kind, tuple(kinds), free & fits, free & ~fits, standing_lo, standing_hi)


def _rotations(item: Item) -> Floats:
    """Return the allowed rotations ``(k, 3, 3)``; of a continuous freedom only the part as it stands."""
    return item.orientations.matrices if item.orientations.freedom == "list" else np.eye(3)[None]


def _variants(boxes: Boxes, rotations: Floats, space: Space) -> tuple[Variant, ...]:
    """Return one variant per rotation that gives different boxes."""
    found: list[Variant] = []
    seen: set[bytes] = set()
    for rotation in rotations:
        lo, hi = rotated_boxes(boxes.lo, boxes.hi, rotation)
        least = lo.min(axis=0)
        lo, hi = lo - least, hi - least
        key = np.round(np.concatenate((lo, hi)) / SAME).astype(np.int64).tobytes()
        if key in seen:
            continue
        seen.add(key)
        home = find_home(lo, hi, space)
        found.append(Variant(rotation, lo, hi, -least, np.full(3, np.nan) if home is None else home))
    return tuple(found)


def _standing(problem: PackingProblem) -> tuple[Floats, Floats]:
    """Return the boxes of the fixed placements in build coordinates, each ``(m, 3)``."""
    corners = [np.empty((0, 3))], [np.empty((0, 3))]
    for placement in problem.fixed:
        boxes = boxes_of(problem.items[placement.item].volume)
        for side, corner in zip(corners, rotated_boxes(boxes.lo, boxes.hi, placement.rotation), strict=True):
            side.append(corner + placement.translation)
    return np.concatenate(corners[0]), np.concatenate(corners[1])


def placements(
    scene: Scene, items: Sequence[int], variant: Sequence[int], place: Floats
) -> tuple[Placement, ...]:
    """Return the placements of `items`, whose variants' least corners lie at `place` ``(n, 3)``."""
    chosen = [scene.kinds[scene.kind[item]][v] for item, v in zip(items, variant, strict=True)]
    return tuple(
        Placement(int(item), v.rotation, at + v.shift)
        for item, v, at in zip(items, chosen, place, strict=True)
    )
