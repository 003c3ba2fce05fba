"""From a support layout to finished bodies: cells for the edges, connectors up to the faces, all united."""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from amprep.arrays import CONTACT_TOLERANCE
from amprep.cells.answers import Emit, checked
from amprep.cells.instances import CellInstances, classify
from amprep.errors import JobError
from amprep.model import BuildVolume, Lattice, Mesh, PlacedPart, Progress, Stop, SupportBody
from amprep.model.build import MAX_STAND_IN_TRIANGLES
from amprep.model.contacts import BaseRules, ConnectorRules
from amprep.supports.layout import SupportLayout
from amprep.supports.solids.bases import make_bases, with_base
from amprep.supports.solids.beams import clip_beams, lattice_of, of_group, prisms
from amprep.supports.solids.connectors import ColumnSurfaces, find_column_surfaces, foot_boxes
from amprep.supports.solids.drain_holes import cut_drain_holes
from amprep.supports.solids.keep_out import PartObstacles, WallClearance
from amprep.supports.solids.request import make_request
from amprep.supports.solids.unite_group import sheet_of, solid_of

if TYPE_CHECKING:
    from manifold3d import Manifold

DIRECT = BaseRules()
"""Supports stand on the plate as they are."""


def build_supports(
    layout: SupportLayout,
    parts: tuple[PlacedPart, ...],
    emit: Emit,
    *,
    overlap: float,
    connector: ConnectorRules,
    base: BaseRules = DIRECT,
    allow_surface: bool,
    stop: Stop,
    progress: Progress,
    beams: bool | None = None,
    gap: float = 0.0,
    space: BuildVolume | None = None,
) -> tuple[SupportBody, ...]:
    """Turn a layout into supports: one closed solid per support group, or its walls without thickness.

    Cells replace the edges (thesis 3.5); connectors run straight up from the red squares, exactly to the faces,
    knife edges and tips they hold and `overlap` mm into them, never past another face.

    Parameters
    ----------
    emit
        Asks the chosen lattice cell.
    overlap
        mm; less than `amprep.model.CONTACT_TOLERANCE` counts as that.
    connector
        Its kind and measures; walls without thickness always extend.
    base
        What supports stand on at the plate.
    allow_surface
        Whether the target reads walls without thickness.
    stop
        Only asked between groups; what is not finished by then is left out.
    beams
        Whether struts become beams: None as the cell's parameters say, False never.
    gap
        mm that supports keep from walls of parts, sideways; walls without thickness only keep to free voxels.
    space
        What cuts beams off; without it all supports are meshes.

    Raises
    ------
    PluginError
        When the cell's answer does not fit the request.
    JobError
        When the cell cannot be made in this grid.
    """
    if not len(layout.red) or not layout.connected.any():
        return ()
    progress(0.0, "emitting cells")
    meshes = tuple(part.mesh for part in parts)

    def ask(*, extend: bool, beams: bool | None) -> CellInstances:
        request = make_request(
            layout, meshes, overlap=overlap, allow_surface=allow_surface, extend=extend, beams=beams
        )
        return classify(request, checked(request, emit(request)))

    instances, bare = _ask(ask, extend=connector.connector == "extend", beams=beams)
    if instances.sheet.any():
        _require_no_feet(layout, base)
    clearance = WallClearance(layout, gap, max(overlap, CONTACT_TOLERANCE)) if gap > 0.0 else None
    surfaces, obstacles = find_column_surfaces(layout, layout.meshes), PartObstacles(parts, clearance)
    work = _SupportBuilder(layout, parts, surfaces, obstacles, overlap, connector, gap)
    solids, names = [], []
    for group, held in enumerate(layout.group_parts):
        if stop.cancelled.is_set():
            break
        names.append(", ".join(parts[part].label for part in held))
        progress(group / len(layout.group_parts), f"uniting supports of {names[-1]}")
        solids.append(work.drained_solid(group, instances))
    bodies: list[SupportBody] = []
    bases = make_bases(solids, parts, base, space, gap)
    for group, (name, solid, stand) in enumerate(zip(names, solids, bases, strict=True)):
        held = layout.group_parts[group]
        whole = with_base(solid, stand)
        sheet = (
            sheet_of(group, instances, layout, surfaces, overlap=overlap) if instances.sheet.any() else None
        )
        if whole is not None and len(whole.triangles):
            lattice = None
            if bare is not None and space is not None:
                lattice = work.lattice(group, bare, whole, stand, space)
            bodies.append(SupportBody(f"supports of {name}", whole, held, lattice=lattice))
        if sheet is not None and len(sheet.triangles):
            bodies.append(
                SupportBody(f"{'walls' if solid else 'supports'} of {name}", sheet, held, surface=True)
            )
    progress(1.0, "supports finished")
    return tuple(bodies)


def _ask(
    ask: Callable[..., CellInstances], *, extend: bool, beams: bool | None
) -> tuple[CellInstances, CellInstances | None]:
    """Return what the cell made without beams, and with beams if it makes any; walls run up to the part."""
    instances, bare = ask(extend=extend, beams=beams), None
    if instances.cells.beams is not None and len(instances.cells.beams.struts):
        if extend:
            raise JobError(
                "beams end at connectors that are solids: set cells.connector = 'full', 'teeth' or 'point', "
                "or cells.lattice = 'mesh'"
            )
        bare, beams = instances, False
        instances = ask(extend=False, beams=False)
    if not extend and any(template.surface for template in instances.cells.templates):
        instances = ask(extend=True, beams=beams)
    return instances, bare


def _require_no_feet(layout: SupportLayout, base: BaseRules) -> None:
    """Refuse what walls without thickness cannot have."""
    if len(layout.feet):
        raise JobError(
            "supports.grounding = 'anywhere' needs a cell with thickness: walls without any have no feet"
        )
    if base.base != "direct":
        raise JobError(
            f"cells.base = {base.base!r} needs a cell with thickness: walls without any have no feet to widen"
        )


class _SupportBuilder(NamedTuple):
    """What every support group is made from."""

    layout: SupportLayout
    parts: tuple[PlacedPart, ...]
    surfaces: ColumnSurfaces
    obstacles: PartObstacles
    overlap: float
    connector: ConnectorRules
    gap: float

    def solid(self, group: int, instances: CellInstances, *, on_beams: bool = False) -> Mesh | None:
        """Return the solid of a group, or with `on_beams` what of it beams carry."""
        return solid_of(
            group,
            instances,
            self.layout,
            self.surfaces,
            self.obstacles,
            overlap=self.overlap,
            connector=self.connector,
            on_beams=on_beams,
        )

    def drained_solid(self, group: int, instances: CellInstances) -> Mesh | None:
        """Return the solid of a group, with surfaces out for powder where the cell promises them."""
        solid, hole = self.solid(group, instances), instances.cells.hole
        if solid is None or hole == 0.0:
            return solid
        held = [self.parts[part].mesh for part in self.layout.group_parts[group]]
        return cut_drain_holes(
            solid, held, hole, foot_boxes(self.layout, group, max(self.overlap, CONTACT_TOLERANCE))
        )

    def lattice(
        self, group: int, bare: CellInstances, whole: Mesh, stand: "Manifold | None", space: BuildVolume
    ) -> Lattice | None:
        """Return a group's beams with their connectors, None where they do not carry all that the solid carries."""
        overlap, held = max(self.overlap, CONTACT_TOLERANCE), self.layout.group_parts[group]
        mine = of_group(bare.cells, group)
        beams = clip_beams(mine, self.parts, held, space, overlap=overlap, gap=self.gap)
        coarse = None
        if len(whole.triangles) > MAX_STAND_IN_TRIANGLES:
            coarse = with_base(self.solid(group, classify(bare.request, prisms(bare.request))), stand)
        solids = with_base(self.solid(group, bare, on_beams=True), stand)
        return lattice_of(beams, solids, whole, coarse, foot_boxes(self.layout, group, overlap), space)
