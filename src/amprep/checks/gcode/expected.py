"""The objects that a slicer must print of a build: each group of parts and supports that stays together."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import Build
from amprep.model.mesh import Mesh, join_meshes


@dataclass(frozen=True, eq=False)
class ExpectedObject:
    """Parts and supports that a slicer prints as one object.

    Attributes
    ----------
    label
        The labels of its parts.
    names
        The names that the slicer may give to it, as `plain_name` returns them.
    bodies
        Its solids in build coordinates.
    """

    label: str
    names: frozenset[str]
    bodies: tuple[Mesh, ...]

    @cached_property
    def mesh(self) -> Mesh:
        """All bodies; nothing is united."""
        return join_meshes(self.bodies)

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Least and greatest corner of all bodies, each ``(3,)`` mm."""
        lows, highs = zip(*(each.bounds for each in self.bodies), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)


def plain_name(name: str) -> str:
    """Return a name in small letters and digits, with one underscore for everything between them."""
    return re.sub(r"[^0-9a-z]+", "_", name.lower()).strip("_")


def expected_objects(build: Build, *, by_part: bool) -> list[ExpectedObject]:
    """Return the objects of a build.

    Parameters
    ----------
    build
        The build.
    by_part
        Whether the slicer prints each part as an object, without its supports, as Cura does.
    """
    groups = [([index], []) for index in range(len(build.parts))] if by_part else _groups(build)
    first_label: dict[int, str] = {}
    for each in build.parts:
        first_label.setdefault(id(each.part), each.label)
    found = []
    for parts, supports in groups:
        labels = " + ".join(build.parts[part].label for part in parts)
        # copies without supports are instances of one object, which has the label of the first
        shared = first_label[id(build.parts[parts[0]].part)] if len(parts) == 1 else labels
        meshes = [build.parts[part].mesh for part in parts]
        meshes += [build.supports[support].mesh for support in supports]
        names = frozenset(map(plain_name, (labels, shared)))
        found.append(ExpectedObject(labels, names, tuple(each for each in meshes if len(each.triangles))))
    return [each for each in found if each.bodies]


def whole_plate(objects: Sequence[ExpectedObject]) -> ExpectedObject:
    """Return one object of everything."""
    bodies = tuple(body for each in objects for body in each.bodies)
    return ExpectedObject("the whole plate", frozenset(), bodies)


def _groups(build: Build) -> list[tuple[list[int], list[int]]]:
    """Return parts that supports hold together, with these supports; indices ascend."""
    group_of = list(range(len(build.parts)))
    for support in build.supports:
        joined = {group_of[part] for part in support.parts}
        group_of = [min(joined) if group in joined else group for group in group_of]
    return [
        (
            [part for part, group in enumerate(group_of) if group == head],
            [i for i, each in enumerate(build.supports) if each.parts and group_of[each.parts[0]] == head],
        )
        for head in sorted(set(group_of))
    ]
