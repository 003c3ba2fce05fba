"""Keep the solids of support groups that do not change while others lose supports."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from amprep.cells.instances import CellInstances
from amprep.model import SupportBody
from amprep.supports.layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold

Key = bytes


@dataclass(frozen=True)
class KeptSupports:
    """Finished solids of support groups, for builds of the same parts with the same rules.

    Attributes
    ----------
    solids
        Solid of each key, None for a group of which nothing is left.
    bodies
        Bodies of each key, of groups without a base.
    """

    solids: "dict[Key, Manifold | None]" = field(default_factory=dict)
    bodies: dict[Key, list[SupportBody]] = field(default_factory=dict)

    def solid(self, key: Key, make: "Callable[[], Manifold | None]") -> "Manifold | None":
        """Return the solid of a key; it is made once."""
        if key not in self.solids:
            self.solids[key] = make()
        return self.solids[key]

    def bodies_of(self, key: Key, make: Callable[[], list[SupportBody]]) -> list[SupportBody]:
        """Return the bodies of a key; they are made once."""
        if key not in self.bodies:
            self.bodies[key] = make()
        return self.bodies[key]


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
