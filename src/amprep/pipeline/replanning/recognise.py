"""Recognise the parts and supports of a build in a file that another program saved.

Names, numbers and metadata may be gone, but no program changes the order of triangles. A part is recognised by the
rigid motion that takes its triangles to those in the file, a support by being where the motion of its parts takes it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.checks.printed.found import PrintedBody
from amprep.errors import InputError
from amprep.geometry.motions.rigid import angle_deg, displacement, find_motion
from amprep.model import Build, Mesh, Part, PlacedPart, SupportBody
from amprep.pipeline.reading import repair_part
from amprep.pipeline.replanning.records import EditedBuild, EditedPart
from amprep.report.replanning import PartChange
from amprep.threemf.transforms import inverse, round_as_stored

_SUPPORT_KINDS = ("support", "open support")
_PART_KINDS = ("model", "surface")
_NAMES_OF_SUPPORTS = ("supports of ", "walls of ")
_LEAST_ANGLE_DEG = 0.01
_EVERY = 64
"""Of so many triangles one is compared before all are."""


class _BodyCorners(NamedTuple):
    """The corners of a body, in their order.

    Attributes
    ----------
    mesh
        Its triangles.
    ends
        ``(m, 2, 3)`` mm, ends of its beams; None if it has none.
    """

    mesh: Mesh
    ends: Floats | None = None

    @property
    def sizes(self) -> tuple[int, int]:
        """Numbers of triangles and beams."""
        return len(self.mesh.triangles), 0 if self.ends is None else len(self.ends)

    def points(self, every: int = 1) -> Floats:
        """Return the corners ``(n, 3)`` mm, of every so many triangles and beams."""
        corners = self.mesh.vertices[self.mesh.triangles[::every]].reshape(-1, 3)
        return corners if self.ends is None else np.concatenate([corners, self.ends[::every].reshape(-1, 3)])

    def is_at(self, other: "_BodyCorners") -> bool:
        """Tell whether all corners are where those of another shape with as many triangles and beams are."""
        for every in (_EVERY, 1):
            if np.abs(self.points(every) - other.points(every)).max(initial=0.0) > CONTACT_TOLERANCE:
                return False
        return True


class _Bodies:
    """The bodies of a file; each becomes one part or one support."""

    def __init__(self, bodies: Sequence[PrintedBody]) -> None:
        self.all = bodies
        self.free = [each.kind in _PART_KINDS + _SUPPORT_KINDS for each in bodies]
        self._shapes = [
            _BodyCorners(each.mesh, None if each.beams is None else each.beams.ends) for each in bodies
        ]

    def like(self, shape: _BodyCorners) -> Iterator[int]:
        """Yield the free bodies with as many triangles and beams as a part or support has."""
        for number, own in enumerate(self._shapes):
            if self.free[number] and own.sizes == shape.sizes and any(own.sizes):
                yield number

    def motion_of(self, number: int, shape: _BodyCorners) -> Floats | None:
        """Return the motion that takes the corners of a shape to those of a body."""
        return find_motion(shape.points(), self._shapes[number].points())

    def take_at(self, shape: _BodyCorners) -> bool:
        """Take the body that is where a shape is; return whether there is one."""
        for number in self.like(shape):
            if self._shapes[number].is_at(shape):
                self.free[number] = False
                return True
        return False


def recognise(bodies: Sequence[PrintedBody], original: Build, *, places_known: bool) -> EditedBuild:
    """Return what became of the parts and supports of a build.

    Parameters
    ----------
    bodies
        The bodies in the file, mm from the corner of the plate.
    original
        The build as it was written.
    places_known
        False if the placements of `original` mean nothing, so that every part is new.

    Raises
    ------
    InputError, MeshError
        If a part was scaled, mirrored or changed, or an added one is not a solid.
    """
    own = _Bodies(bodies)
    found = _recognised(own, original, places_known)
    supports, sources = _supports(own, original, found) if places_known else ((), ())
    labels = {each.placed.label for each in found}
    added = [
        _added(own.all[number], labels, original)
        for number, free in enumerate(own.free)
        if free and not _is_support(own.all[number], original)
    ]
    kept = {each.was for each in found if each.change != "copied"}
    deleted = [each.label for index, each in enumerate(original.parts) if index not in kept]
    return EditedBuild((*found, *added), supports, sources, tuple(deleted) if places_known else ())


def _is_support(body: PrintedBody, original: Build) -> bool:
    """Tell whether a body that is no known part was a support: by its kind, or as what is named after a part."""
    named = tuple(f"{kind}{each.label}" for kind in _NAMES_OF_SUPPORTS for each in original.parts)
    return body.kind in _SUPPORT_KINDS or body.name.startswith(named)


def _recognised(own: _Bodies, original: Build, places_known: bool) -> list[EditedPart]:
    """Return the parts of the original that are in the file, in the order of the original, then their copies."""
    matches: list[tuple[float, int, int, Floats]] = []
    for part in dict.fromkeys(each.part for each in original.parts):
        shape = _BodyCorners(part.mesh)
        for number in own.like(shape):
            is_support = own.all[number].kind in _SUPPORT_KINDS
            if not is_support and (matrix := own.motion_of(number, shape)) is not None:
                matches += [
                    (_badness(own.all[number], each, matrix), number, index, matrix)
                    for index, each in enumerate(original.parts)
                    if each.part is part
                ]
    found: dict[int, EditedPart] = {}
    copies: dict[int, tuple[int, Floats]] = {}
    for _, number, index, matrix in sorted(matches, key=lambda each: each[:3]):
        if own.free[number] and index not in found:
            found[index] = _edited(original.parts[index], index, matrix, places_known)
            own.free[number] = False
    for _, number, index, matrix in sorted(matches, key=lambda each: each[:3]):
        if own.free[number]:
            own.free[number] = False
            copies[number] = index, matrix
    taken = {each.label for each in original.parts}
    return [
        *(found[index] for index in sorted(found)),
        *(
            _copy(original.parts[index], index, copies[number][1], taken, places_known)
            for number, (index, _) in sorted(copies.items())
        ),
    ]


def _badness(body: PrintedBody, placed: PlacedPart, matrix: Floats) -> float:
    """Return how unlikely it is that a body is this copy of its part: 0 for one that did not move."""
    far = displacement(placed.part.mesh.bounds, placed.matrix, matrix)
    if far <= CONTACT_TOLERANCE:
        return 0.0
    other_name = body.name not in (placed.label, placed.part.name)
    other_way = not _is_along_plate(placed, matrix @ inverse(placed.matrix))
    return far + 1e6 * other_name + 1e5 * other_way


def _is_along_plate(placed: PlacedPart, motion: Floats) -> bool:
    """Return whether a motion ``(4, 4)`` is a translation parallel to the plate."""
    along = np.eye(4)
    along[:2, 3] = (motion @ [*placed.mesh.bounds[0], 1.0])[:2] - placed.mesh.bounds[0][:2]
    return displacement(placed.mesh.bounds, along, motion) <= CONTACT_TOLERANCE


def _edited(placed: PlacedPart, index: int, matrix: Floats, places_known: bool) -> EditedPart:
    """Return a part at its new place ``(4, 4)``; one that did not move stays exactly where it was."""
    if not places_known:
        return EditedPart(replace(placed, matrix=round_as_stored(matrix)), index, "added")
    motion = matrix @ inverse(placed.matrix)
    if displacement(placed.mesh.bounds, np.eye(4), motion) <= CONTACT_TOLERANCE:
        return EditedPart(placed, index, "none", slides=True)
    if _is_along_plate(placed, motion):
        motion = _along_plate(placed, motion)
        moved = replace(placed, matrix=round_as_stored(motion @ placed.matrix), recorded_digest="")
        return EditedPart(moved, index, "moved", motion, slides=True)
    turned = angle_deg(motion) > _LEAST_ANGLE_DEG
    change: PartChange = "turned" if turned else "moved"
    moved = replace(placed, matrix=round_as_stored(matrix), recorded_digest="")
    return EditedPart(moved, index, change, motion)


def _along_plate(placed: PlacedPart, motion: Floats) -> Floats:
    """Return the translation ``(4, 4)`` of a motion along the plate, to a tenth of a micrometre."""
    along = np.eye(4)
    middle = np.array([*placed.mesh.bounds]).mean(axis=0)
    along[:2, 3] = np.round((motion @ [*middle, 1.0])[:2] - middle[:2], 4)
    return along


def _copy(placed: PlacedPart, index: int, matrix: Floats, taken: set[str], places_known: bool) -> EditedPart:
    """Return a copy of a part under a label that is not taken yet, which it takes."""
    label = _free_label(placed.part.name, taken)
    found = _edited(replace(placed, label=label), index, matrix, places_known)
    return replace(found, change="copied") if places_known else found


def _free_label(name: str, taken: set[str]) -> str:
    label = next(
        each for number in count(1) if (each := f"{name}-{number}" if number > 1 else name) not in taken
    )
    taken.add(label)
    return label


def _supports(
    own: _Bodies, original: Build, found: Sequence[EditedPart]
) -> tuple[tuple[SupportBody, ...], tuple[int, ...]]:
    """Return the supports that are where the motion of their parts takes them, and their indices in the original."""
    supports, sources = [], []
    for held, motion in _moved_together(original, found):
        for index, body in enumerate(original.supports):
            if tuple(held) == body.parts and _is_intact(body):
                moved = _moved(body, motion, tuple(held.values()), found)
                if own.take_at(_shape(moved)):
                    supports.append(moved)
                    sources.append(index)
    return tuple(supports), tuple(sources)


def _moved_together(original: Build, found: Sequence[EditedPart]) -> Iterator[tuple[dict[int, int], Floats]]:
    """Yield the parts that a support holds, each with its index among the found ones, and their common motion."""
    whole = {each.was: number for number, each in enumerate(found) if each.change != "copied"}
    for held in dict.fromkeys(body.parts for body in original.supports):
        motions = [found[whole[each]].motion for each in held if each in whole]
        together = len(motions) == len(held) and all(np.array_equal(motions[0], each) for each in motions)
        if together and all(found[whole[each]].slides for each in held):
            yield {each: whole[each] for each in held}, motions[0]
    for number, each in enumerate(found):
        if each.change == "copied" and each.slides and each.was is not None:
            yield {each.was: number}, each.motion


def _is_intact(body: SupportBody) -> bool:
    """Return whether a support is as its file records it; files of earlier versions record nothing."""
    stored = body.stored
    return stored is None or stored.recorded_digest in ("", stored.digest)


def _shape(body: SupportBody) -> _BodyCorners:
    """Return the shape by which a support is recognised."""
    lattice = body.lattice
    return (
        _BodyCorners(body.mesh)
        if lattice is None
        else _BodyCorners(lattice.solids, lattice.nodes[lattice.struts])
    )


def _moved(
    body: SupportBody, motion: Floats, held: tuple[int, ...], found: Sequence[EditedPart]
) -> SupportBody:
    """Return a support that moved along with its parts."""
    named = ", ".join(found[each].placed.label for each in held)
    name = _renamed(body.name, named) if any(found[each].change == "copied" for each in held) else body.name
    moved = replace(body, parts=held, name=name, stored=None)
    if np.array_equal(motion, np.eye(4)):
        return moved
    lattice, shift = body.lattice, motion[:3, 3]
    if lattice is not None:
        lattice = replace(
            lattice,
            nodes=lattice.nodes + shift,
            solids=lattice.solids.moved(motion),
            stand_in=lattice.stand_in.moved(motion),
        )
    return replace(moved, mesh=body.mesh.moved(motion), lattice=lattice)


def _renamed(name: str, parts: str) -> str:
    """Return the name of a support of other parts; it may end in the rule that planned it."""
    kind, _, rest = name.partition(" of ")
    rule = rest.rpartition(", rule ")[2]
    return f"{kind} of {parts}" + (f", rule {rule}" if ", rule " in rest else "")


def _added(body: PrintedBody, taken: set[str], original: Build) -> EditedPart:
    """Return a part that is not of the original build, unrotated, where the file has it.

    Raises
    ------
    InputError
        If it has the name of a part of the original build: it is that part, changed; or no triangles.
    """
    names = {name for each in original.parts for name in (each.label, each.part.name)}
    if body.name in names:
        raise InputError(
            f"{body.name} has another shape than the build recorded: it was scaled, mirrored, cut or repaired; "
            "run the job again with the new shape, or give the part another name"
        )
    if not len(body.mesh.triangles):
        raise InputError(f"{body.name} has no triangles, so it is no part; delete it in the file")
    low = body.mesh.bounds[0]
    matrix = np.eye(4)
    matrix[:3, 3] = low
    label = _free_label(body.name or "part", taken)
    part = repair_part(
        Part(label, Mesh(body.mesh.vertices - low, body.mesh.triangles), 0.0), allow_surface=False
    )
    return EditedPart(PlacedPart(label, part, round_as_stored(matrix)), None, "added")
