"""Support equal copies of a part once, and move the supports of one to the others."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.geometry.meshes.welding import round_as_stored
from amprep.geometry.powder.pockets import Pocket
from amprep.job import Job
from amprep.measures.removability import Removal
from amprep.model import Build, BuildVolume, Mesh, PlacedPart, SupportBody, Unsupported
from amprep.overhangs.known import moved_in_plan
from amprep.overhangs.of_part import PartOverhangs
from amprep.pipeline.packing import PackedBuild
from amprep.supports.grid.territory import margin_of

_BORDER_DIGITS = 6
"""Digits after the point of distances (mm) from the border of the plate that are compared."""

# Strategy. Supports stay in the territory of their part, and planning looks at other parts only where these come near
# it. So copies in the same rotation and at the same height have the same supports, moved, where nothing else is near
# and the border of the plate is as far, or so far that it does not matter. One of them is planned, together with all
# parts that have no such copy, and the grid is laid for these alone: where the copies are on it makes no difference.


class EqualCopies(NamedTuple):
    """The parts of a build, and which of them get supports that are planned for another one.

    Attributes
    ----------
    parts
        All parts of the build.
    planned
        Indices of the parts for which supports are planned.
    like
        For each part, the position in `planned` of the part whose supports it gets.
    shift
        ``(n, 3)`` mm from that part to each part.
    """

    parts: tuple[PlacedPart, ...]
    planned: tuple[int, ...]
    like: tuple[int, ...]
    shift: Floats

    @property
    def planned_parts(self) -> tuple[PlacedPart, ...]:
        """The parts for which supports are planned."""
        return tuple(self.parts[each] for each in self.planned)

    def all_overhangs(self, found: Sequence[PartOverhangs]) -> tuple[PartOverhangs, ...]:
        """Return the overhangs of all parts, from those of the planned ones."""
        return tuple(
            moved_in_plan(found[own], shift) if shift.any() else found[own]
            for own, shift in zip(self.like, self.shift, strict=True)
        )

    def of(self, planned: int) -> list[tuple[str, Floats]]:
        """Return the label of each part that gets the supports of a planned one, and the shift to it."""
        return [
            (self.parts[each].label, self.shift[each]) for each, own in enumerate(self.like) if own == planned
        ]

    def expand(self, build: Build, removal: Sequence[Removal]) -> tuple[Build, tuple[Removal, ...]]:
        """Return the build with all parts and their supports, and the figures of each support body."""
        copies = [
            [each for each, own in enumerate(self.like) if own == place] for place in range(len(self.planned))
        ]
        bodies: list[SupportBody] = []
        figures: list[Removal] = []
        for body, figure in zip(build.supports, removal, strict=True):
            if len(body.parts) > 1:  # parts that share supports have no copies
                bodies.append(replace(body, parts=tuple(self.planned[each] for each in body.parts)))
                figures.append(figure)
                continue
            for each in copies[body.parts[0]]:
                bodies.append(self._moved_body(body, each))
                figures.append(_moved_figures(figure, self.shift[each]))
        unsupported = [
            self._moved_region(region, each) for region in build.unsupported for each in copies[region.part]
        ]
        return Build(build.settings, self.parts, tuple(bodies), tuple(unsupported)), tuple(figures)

    def _name_in_place(self, name: str, part: int) -> str:
        """Return the name of a support or region of a planned part, with the label of a part like it."""
        label = self.parts[self.planned[self.like[part]]].label
        kind, of, rest = name.partition(" of ")
        return kind + of + self.parts[part].label + rest[len(label) :]

    def _moved_body(self, body: SupportBody, part: int) -> SupportBody:
        shift = self.shift[part]
        if not shift.any():
            return replace(body, parts=(part,))
        lattice = body.lattice
        if lattice is not None:
            solids, stand_in = (_moved_mesh(each, shift) for each in (lattice.solids, lattice.stand_in))
            lattice = replace(lattice, nodes=lattice.nodes + shift, solids=solids, stand_in=stand_in)
        name, mesh = self._name_in_place(body.name, part), _moved_mesh(body.mesh, shift)
        return replace(body, name=name, mesh=mesh, parts=(part,), lattice=lattice)

    def _moved_region(self, region: Unsupported, part: int) -> Unsupported:
        label, points = self._name_in_place(region.label, part), region.points + self.shift[part]
        return replace(region, part=part, label=label, points=points)


def find_equal_copies(build: PackedBuild) -> EqualCopies | None:
    """Return which parts of a build get the supports of another one; None if each is planned by itself."""
    jobs = [
        build.resolved.job,
        *(build.resolved.for_rule(each + 1).job for each in range(len(build.resolved.job.rules))),
    ]
    if build.kept or not all(_stay_apart(job) for job in jobs):
        return None
    gap, parts = max(job.supports.gap_mm for job in jobs), build.parts
    margins = np.array([max(margin_of(each, job.supports) for job in jobs) for each in parts])
    boxes = np.array([each.mesh.bounds for each in parts]).reshape(-1, 2, 3)
    alone = _are_alone(boxes[:, :, :2], margins, gap)
    first: dict[tuple[object, ...], int] = {}
    planned: list[int] = []
    like: list[int] = []
    for number, each in enumerate(parts):
        border = _border_distances(boxes[number], margins[number] + gap, jobs[0].printer.space)
        key: tuple[object, ...] = (number,)
        if alone[number] and border is not None:
            key = id(each.part), each.matrix[:3, :3].tobytes(), float(each.matrix[2, 3]), border
        if key not in first:
            first[key] = len(planned)
            planned.append(number)
        like.append(first[key])
    if len(planned) == len(parts):
        return None
    shift = np.zeros((len(parts), 3))
    for number, own in enumerate(like):
        shift[number, :2] = (parts[number].matrix - parts[planned[own]].matrix)[:2, 3]
    return EqualCopies(parts, tuple(planned), tuple(like), shift)


def _stay_apart(job: Job) -> bool:
    """Tell whether the supports of a job stay in the territories of their parts, and their bases with them."""
    return job.supports.enabled and job.supports.territory == "own" and job.cells.base == "direct"


def _are_alone(boxes: Floats, margins: Floats, gap: float) -> Bools:
    """Tell which parts ``(n,)`` have a territory that no other part comes near, from boxes ``(n, 2, 2)`` mm in plan.

    Territories reach as far as the margin ``(n,)`` mm; supports and walls of parts keep a distance of `gap` mm.
    """
    alone = np.ones(len(boxes), np.bool_)
    for number, (low, high) in enumerate(boxes):
        distance = np.maximum(boxes[:, 0] - high, low - boxes[:, 1]).max(axis=1)
        near = distance < margins[number] + np.maximum(margins, gap) - CONTACT_TOLERANCE
        alone[number] = near.sum() == 1  # the part itself
    return alone


def _border_distances(box: Floats, margin: float, space: BuildVolume) -> tuple[float, ...] | None:
    """Return the distances (mm) of a box from the sides of the plate, at most a margin; None near other borders."""
    low, high = box[0, :2] - margin, box[1, :2] + margin
    if ((space.zone_lo[:, :2] < high) & (space.zone_hi[:, :2] > low)).all(axis=1).any():
        return None
    if space.shape == "cylinder":
        radius = space.size[0] / 2.0
        farthest = np.hypot(*np.maximum(np.abs(low - radius), np.abs(high - radius)))
        return () if farthest <= radius else None
    distances = np.minimum(np.concatenate([box[0, :2], space.size[:2] - box[1, :2]]), margin)
    return tuple(np.round(distances, _BORDER_DIGITS).tolist())


def _moved_mesh(mesh: Mesh, shift: Floats) -> Mesh:
    return Mesh(round_as_stored(mesh.vertices + shift), mesh.triangles)


def _moved_figures(figures: Removal, shift: Floats) -> Removal:
    """Return the figures of a support that is moved by a shift."""

    def moved(pockets: Sequence[Pocket]) -> Iterator[Pocket]:
        for each in pockets:
            point, lo, hi = (
                tuple((np.array(place) + shift).tolist()) for place in (each.point, each.lo, each.hi)
            )
            yield each._replace(point=point, lo=lo, hi=hi)

    pockets = None if figures.pockets is None else tuple(moved(figures.pockets))
    return replace(figures, pockets=pockets, cavities=tuple(moved(figures.cavities)))
