"""Keep the solids of support groups that do not change while others lose supports."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.cells.instances import CellInstances
from amprep.model import SupportBody
from amprep.supports.layout import SupportLayout
from amprep.workers import share_out

if TYPE_CHECKING:
    from manifold3d import Manifold

Key = bytes


class GroupWork(NamedTuple):
    """The work on all support groups of a layout.

    Attributes
    ----------
    keys
        What the support of each group is made of, as `key_of` tells.
    triangles
        Estimated number of triangles of each.
    is_cancelled
        Tells whether to end early.
    done
        Called with the number of groups that are done.
    """

    keys: Sequence[Key]
    triangles: Sequence[float]
    is_cancelled: Callable[[], bool]
    done: Callable[[int], None]


@dataclass(frozen=True)
class KeptSupports:
    """Finished solids of support groups, for builds of the same parts with the same rules.

    Attributes
    ----------
    solids
        Solid of each key, None for a group of which nothing is left.
    bodies
        Bodies of each key, of groups without a base.
    wide
        In which columns footprints are wide enough, see `amprep.geometry.connectors.least_width.find_wide`.
    """

    solids: "dict[Key, Manifold | None]" = field(default_factory=dict)
    bodies: dict[Key, list[SupportBody]] = field(default_factory=dict)
    wide: dict[bytes, Bools] = field(default_factory=dict)

    def solid(self, key: Key, make: "Callable[[], Manifold | None]") -> "Manifold | None":
        """Return the solid of a key; it is made once."""
        if key not in self.solids:
            self.solids[key] = make()
        return self.solids[key]

    def all_bodies(
        self, work: GroupWork, make: Callable[[int], list[SupportBody]]
    ) -> list[list[SupportBody]]:
        """Return the bodies of all groups; those of a key are made once, in as many processes as are allowed.

        When cancelled, only the bodies of the first groups are returned.
        """
        missing = [group for group, key in enumerate(work.keys) if key not in self.bodies]
        known = len(work.keys) - len(missing)
        found = share_out(
            lambda number: make(missing[number]),
            [work.triangles[group] for group in missing],
            is_cancelled=work.is_cancelled,
            done=lambda count: work.done(known + count),
        )
        self.bodies.update({work.keys[group]: each for group, each in zip(missing, found, strict=False)})
        until = missing[len(found)] if len(found) < len(missing) else len(work.keys)
        return [self.bodies[key] for key in work.keys[:until]]


def key_of(layout: SupportLayout, group: int, *answers: CellInstances | None) -> Key:
    """Return a digest of all that the support of a group is made of, apart from parts and rules.

    These are its red squares, its feet, and its cells in each answer of the cell.
    """
    return b"".join(_digest(layout, group, each) for each in answers if each is not None)


def _digest(layout: SupportLayout, group: int, instances: CellInstances) -> bytes:
    """Return a digest of red squares, feet and cells: the templates, their maps, and the edges that they replace."""
    digest = hashlib.sha256(repr(layout.group_parts[group]).encode())
    red = layout.connected & (layout.red_group == group)
    chosen, cells = instances.of(group), instances.cells
    edges = instances.request.edges
    arrays = [each[red] for each in layout.red]
    arrays += [layout.feet[np.isin(layout.feet[:, 3], layout.group_parts[group])]]
    arrays += [
        cells.template[chosen],
        cells.matrix[chosen],
        instances.tiles[chosen],
        instances.connector[chosen],
    ]
    arrays += [edges.upper[cells.edge[chosen]], edges.lower[cells.edge[chosen]]]
    for each in arrays:
        digest.update(repr(each.shape).encode() + np.ascontiguousarray(each).tobytes())
    for template in cells.templates:
        digest.update(template.mesh.digest.encode() + bytes([template.surface]))
    for extra in cells.extra:
        if extra.group == group:
            digest.update(extra.mesh.digest.encode() + bytes([extra.surface]))
    return digest.digest()
