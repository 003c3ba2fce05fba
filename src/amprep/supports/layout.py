"""The support layout: what was planned for a whole build, ready to be turned into cells."""

from dataclasses import dataclass, field

import numpy as np

from amprep.arrays import Bools, Bytes, Floats, Int64s, Ints, frozen
from amprep.geometry.overhangs.regions import Overhangs
from amprep.geometry.voxels.grid import Grid
from amprep.model.mesh import Mesh
from amprep.model.supports import CONNECTOR_BLOCKED, NO_FREE_VOXEL_BELOW
from amprep.model.supports.edges import SupportEdges
from amprep.overhangs.of_part import PartOverhangs
from amprep.supports.grid.red_squares import RedSquares


@dataclass(frozen=True, eq=False)
class SupportLayout:
    """Red squares of all parts, the edges that carry their flow, and the support groups these form.

    Attributes
    ----------
    voxels
        ``(nz, ny, nx)`` uint8, values of `amprep.model.supports.Voxel`.
    meshes
        One per placed part, in build coordinates: its own, or split finer where blockers and enforcers end.
    overhangs
        One per placed part; indices into `meshes`.
    red
        ``(m, 3)`` int32 plane, y, x; sorted. A square appears once per part that needs it. Those on plane 0
        need no support of their own ("what lies in the layer on the plate"): connected, without edges.
    red_part, red_region
        ``(m,)`` int32: placed part; region of its overhangs (the one of least label in the square's column).
    red_rise
        ``(m,)`` int32: occupied voxels from the red square upwards that its connector may pass, the
        contiguous run of voxels of the column that hold needed geometry of the part.
    connected
        ``(m,)`` bool.
    reasons
        ``m`` words: why a red square is unconnected, ``""`` when it is connected.
    edges
        Edges with their part and group; an edge that several parts share appears once.
    feet
        ``(k, 5)`` int32: where columns end on a part instead of the plate; see
        `amprep.supports.routes.on_part.Grounded`.
    red_group
        ``(m,)`` int32: support group, -1 for red squares that are not connected; one group per part, merged
        where parts share squares.
    group_parts
        Placed parts each group holds; more than one only where squares are shared.
    notes
        Sentences for the user: what the router says, which columns stand on parts or are joined.
    shared
        Which parts share supports, one sentence for each group of more than one part.
    """

    frame: Grid
    voxels: Bytes
    meshes: tuple[Mesh, ...]
    overhangs: tuple[Overhangs, ...]
    red: Ints
    red_part: Ints
    red_region: Ints
    red_rise: Ints
    connected: Bools
    reasons: tuple[str, ...]
    edges: SupportEdges
    red_group: Ints
    group_parts: tuple[tuple[int, ...], ...]
    notes: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    feet: Ints = field(default_factory=lambda: np.empty((0, 5), np.int32))

    def __post_init__(self) -> None:
        for name in ("red_part", "red_region", "red_rise", "red_group"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int32))
        object.__setattr__(self, "red", frozen(self.red, np.int32, 3))
        object.__setattr__(self, "feet", frozen(self.feet, np.int32, 5))
        object.__setattr__(self, "voxels", frozen(self.voxels, np.uint8))
        object.__setattr__(self, "connected", frozen(self.connected, np.bool_))

    @property
    def part_overhangs(self) -> tuple[PartOverhangs, ...]:
        """The overhangs of each placed part, with the mesh that their indices refer to."""
        return tuple(map(PartOverhangs, self.meshes, self.overhangs))

    def reason_at(self, part: int, points: Floats) -> tuple[str, ...]:
        """Say for each point ``(n, 3)`` mm of a part's unsupported overhangs why nothing holds it.

        The red square that counts is the highest of the part in the point's column that is not above the
        point. When the point is within its rise it gives its reason or, connected, the connector does not get
        there; otherwise no voxel below the point is white.
        """
        reds = np.flatnonzero(self.red_part == part)
        key = self._heights(self.red[reds])
        order = np.argsort(key)
        size = (self.frame.pitch, self.frame.pitch, self.frame.step)
        voxel = np.floor((points - self.frame.origin) / size + (0.0, 0.0, 0.5)).astype(np.int64)[:, ::-1]
        below = np.searchsorted(key[order], self._heights(voxel), side="right") - 1
        reasons = [NO_FREE_VOXEL_BELOW] * len(points)
        for i in np.flatnonzero(below >= 0):
            red = reds[order[below[i]]]
            within = voxel[i, 0] <= self.red[red, 0] + self.red_rise[red]
            if within and (self.red[red, 1:] == voxel[i, 1:]).all():
                reasons[i] = CONNECTOR_BLOCKED if self.connected[red] else self.reasons[red]
        return tuple(reasons)

    def _heights(self, square: Ints | Int64s) -> Int64s:
        """Return the place of squares ``(n, 3)`` in the order of columns, upwards in each."""
        nz, _, nx = self.frame.shape
        plane, y, x = square.T.astype(np.int64)
        return np.asarray((y * nx + x) * (nz + 2) + np.clip(plane, 0, nz + 1), np.int64)


def groups_of(
    edges: SupportEdges, red: RedSquares, connected: Bools, count: int
) -> tuple[Ints, Ints, tuple[tuple[int, ...], ...]]:
    """Return the group of each red square ``(m,)`` (-1: none), of each edge ``(n,)``, and the parts of each group."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, of_red = edges.components(red.square[connected])
    part = red.part[connected]
    owner = np.full(int(of_red.max(initial=-1)) + 1, -1)
    owner[of_red[::-1]] = part[::-1]
    graph = coo_array((np.ones(len(part)), (part, owner[of_red])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    used, number = np.unique(label[part], return_inverse=True)
    group = np.full(len(red.part), -1, np.int32)
    group[connected] = number
    edge_group = np.searchsorted(used, label[edges.part]).astype(np.int32)
    held = [sorted(set(part[number == i].tolist())) for i in range(len(used))]
    return group, edge_group, tuple(tuple(each) for each in held)
