"""The gap between supports and the walls of parts: what comes nearer is cut off."""

from typing import TYPE_CHECKING

from amprep.geometry.cell_solids import arrays_of
from amprep.geometry.walls import beside, occupied, walls_of
from amprep.pipeline.support_layout import SupportLayout

if TYPE_CHECKING:
    from manifold3d import Manifold


class Clearance:
    """The walls of all parts of a build, with the distance that supports keep from them.

    Routing closes what is nearer than the gap, except where connectors run up and right below them.
    """

    def __init__(self, layout: SupportLayout, gap: float, overlap: float) -> None:
        self._gap = gap
        stood_on = set(layout.feet[:, 3].tolist())
        self._walls = [
            walls_of(mesh.vertices, mesh.triangles, needs, overlap, stood_on=part in stood_on)
            for part, (mesh, needs) in enumerate(zip(layout.meshes, layout.overhangs, strict=True))
        ]

    def keep(self, solid: "Manifold") -> "Manifold":
        """Return what of a solid is as far from all walls as asked, measured sideways."""
        from manifold3d import Manifold, OpType

        points, triangles = arrays_of(solid)
        corners = points[triangles]
        taken = occupied(corners.min(axis=1), corners.max(axis=1))
        cutters: list[Manifold] = []
        for walls in self._walls:
            cutters += beside(walls.chosen(taken.near(walls.corners, self._gap)), self._gap)
        return solid - Manifold.batch_boolean(cutters, OpType.Add) if cutters else solid
