"""Build the support bodies of a layout: cells for its edges, connectors up to the parts, bases, all united."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from amprep.arrays import CONTACT_TOLERANCE
from amprep.cells.answers import Emit, checked
from amprep.cells.instances import CellInstances, classify
from amprep.errors import JobError
from amprep.geometry.connectors.least_width import LeastSection
from amprep.model import BuildVolume, Lattice, Mesh, PlacedPart, Progress, Stop, SupportBody
from amprep.model.build import MAX_STAND_IN_TRIANGLES
from amprep.model.contacts import BaseRules, ConnectorRules
from amprep.supports.layout import SupportLayout
from amprep.supports.legs.kept_supports import GroupWork, KeptSupports, key_of
from amprep.supports.solids.bases import make_bases, plan_of_others
from amprep.supports.solids.beams import beams_of_group, clip_beams, lattice_of, whole_prisms
from amprep.supports.solids.connectors import find_column_surfaces
from amprep.supports.solids.drain_holes import cut_drain_holes
from amprep.supports.solids.keep_out import PartObstacles, WallClearance, drop_idle
from amprep.supports.solids.least_section import without_narrow
from amprep.supports.solids.request import make_request
from amprep.supports.solids.territory import territory_section
from amprep.supports.solids.thin_rests import NO_HOLES, without_thin_rests
from amprep.supports.solids.unite_group import (
    SupportContext,
    sheet_of,
    solid_of,
    stored_solid,
    unite_patterns,
)

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_TRIANGLES_OF_CELL = 50.0
"""Number of triangles for which a cell counts when work is estimated."""


@dataclass(frozen=True, kw_only=True)
class SolidRules:
    """Rules for the bodies of supports.

    Attributes
    ----------
    connector
        Shape of the connectors; walls without thickness always extend up to the part.
    base
        Shape of the bases on the build plate.
    overlap
        Depth (mm) to which connectors enter parts; a value below `CONTACT_TOLERANCE` counts as that.
    allow_surface
        Whether the target reads walls without thickness.
    beams
        Whether struts become beams: None leaves it to the parameters of the cell, False forbids it.
    gap
        XY distance (mm) between supports and walls of parts; walls without thickness only stay in free voxels.
    space
        Build volume, which clips beams and bases; without it struts become meshes.
    least
        Least section of connectors; None for none.
    leg_ratio
        Largest ratio of length to width of a leg; 0 for no limit.
    """

    connector: ConnectorRules = field(default_factory=ConnectorRules)
    base: BaseRules = field(default_factory=BaseRules)
    overlap: float = 0.1
    allow_surface: bool = False
    beams: bool | None = None
    gap: float = 0.0
    space: BuildVolume | None = None
    least: LeastSection | None = None
    leg_ratio: float = 0.0


@dataclass(frozen=True)
class Surroundings:
    """What else belongs to the build of the supports of one pass.

    Attributes
    ----------
    earlier
        Bodies of earlier passes of planning; connectors and bases keep out of them.
    later
        Layouts of later passes; bases keep clear of the squares on the plate that they stand on.
    kept
        Solids of groups; those of other layouts of this pass are made no second time.
    """

    earlier: Sequence[SupportBody] = ()
    later: Sequence[SupportLayout] = ()
    kept: KeptSupports = field(default_factory=KeptSupports)


def least_wall_of(rules: SolidRules) -> float:
    """Return the least wall, mm; 0 where there is none."""
    return 0.0 if rules.least is None else rules.least.width


def build_supports(
    layout: SupportLayout,
    parts: tuple[PlacedPart, ...],
    emit: Emit,
    rules: SolidRules,
    *,
    around: "Surroundings | None" = None,
    stop: Stop,
    progress: Progress,
) -> tuple[SupportBody, ...]:
    """Turn a layout into support bodies: one closed solid per support group, or its walls without thickness.

    Cells replace the edges (thesis 3.5). Connectors run straight up from the red squares to the overhangs, enter them
    by the overlap, and pass no other face.

    Parameters
    ----------
    layout
        Routed supports of the build.
    parts
        Placed parts of the build.
    emit
        Calls the chosen lattice cell.
    rules
        Connectors, bases, distances, and the kinds of bodies that the target reads.
    around
        Supports of other passes of planning, and what is kept of earlier layouts; None for none.
    stop
        Checked between groups; groups that are not finished by then are left out.
    progress
        Callback for progress.

    Raises
    ------
    PluginError
        When the answer of the cell does not fit the request.
    JobError
        When the cell cannot be made in this grid.
    """
    if not len(layout.red.square) or not layout.connected.any():
        return ()
    around = Surroundings() if around is None else around
    progress(0.0, "emitting cells")
    meshes = tuple(part.mesh for part in parts)
    surfaces, posts = find_column_surfaces(layout), None
    if rules.least is not None:
        layout, surfaces, posts = without_narrow(layout, surfaces, rules.least, around.kept.wide)
        if not layout.connected.any():
            return ()

    def ask(*, extend: bool, beams: bool | None) -> CellInstances:
        request = make_request(
            layout,
            meshes,
            overlap=rules.overlap,
            allow_surface=rules.allow_surface,
            extend=extend,
            beams=beams,
            least_wall=least_wall_of(rules),
            leg_ratio=rules.leg_ratio,
        )
        return classify(request, checked(request, emit(request)))

    instances, as_beams = _ask(ask, extend=rules.connector.connector == "extend", beams=rules.beams)
    if instances.sheet.any():
        _require_no_feet(layout, rules.base)
    depth = max(rules.overlap, CONTACT_TOLERANCE)
    clearance = WallClearance(layout, rules.gap, depth) if rules.gap > 0.0 else None
    obstacles = PartObstacles(parts, clearance, around.earlier)
    context = SupportContext(layout, surfaces, obstacles, rules.connector, depth, posts, rules.least)
    unite_patterns(context, instances)
    builder = _SupportBuilder(context, parts, instances, as_beams, rules)
    names = [", ".join(parts[part].label for part in held) for held in layout.group_parts]
    keys = [key_of(layout, group, instances, as_beams) for group in range(len(names))]
    cells = [float(instances.of(group).sum()) for group in range(len(names))]
    work = GroupWork(
        keys, [_TRIANGLES_OF_CELL * each for each in cells], stop.cancelled.is_set, _shown(progress, names)
    )
    if rules.base.base == "direct":
        found = around.kept.all_bodies(work, partial(builder.finished_bodies, names))
    else:
        beside = plan_of_others(around.earlier, around.later, rules.base)
        found = _with_bases(builder, names, around.kept, work, beside)
    progress(1.0, "supports finished")
    return tuple(body for bodies in found for body in bodies)


def _shown(progress: Progress, names: Sequence[str]) -> Callable[[int], None]:
    """Return a callback that shows how many groups are done."""
    return lambda count: progress(count / len(names), f"uniting supports, {count} of {len(names)} done")


def _with_bases(
    builder: "_SupportBuilder",
    names: Sequence[str],
    kept: KeptSupports,
    work: GroupWork,
    beside: "CrossSection | None",
) -> list[list[SupportBody]]:
    """Return the bodies of all groups with their bases, which keep clear of all solids, and of the region `beside`."""
    rules, layout = builder.rules, builder.context.layout
    solids: list[Manifold | None] = []
    for group, key in enumerate(work.keys):
        if work.is_cancelled():
            break
        solids.append(kept.solid(key, partial(builder.drained_solid, group)))
        work.done(group + 1)
    regions = [territory_section(layout, group) for group in range(len(solids))]
    bases = make_bases(solids, builder.parts, rules.base, rules.space, rules.gap, beside, regions)
    finished = enumerate(zip(solids, bases, strict=True))
    return [builder.bodies(group, names[group], solid, base) for group, (solid, base) in finished]


def _ask(
    ask: Callable[..., CellInstances], *, extend: bool, beams: bool | None
) -> tuple[CellInstances, CellInstances | None]:
    """Return the answer of the cell without beams, and that with beams if it makes any.

    A cell with templates without thickness is asked again for cells that extend up to the part.
    """
    instances, as_beams = ask(extend=extend, beams=beams), None
    if instances.cells.beams is not None and len(instances.cells.beams.struts):
        if extend:
            raise JobError(
                "beams need connectors that are solids: set cells.connector = 'full', 'teeth' or 'point', "
                "or cells.lattice = 'mesh'"
            )
        as_beams, beams = instances, False
        instances = ask(extend=False, beams=False)
    if not extend and any(template.surface for template in instances.cells.templates):
        instances = ask(extend=True, beams=beams)
    return instances, as_beams


def _require_no_feet(layout: SupportLayout, base: BaseRules) -> None:
    """Refuse feet on parts and bases, which walls without thickness cannot have."""
    if len(layout.feet):
        raise JobError(
            "supports.grounding = 'anywhere' needs a cell with thickness; walls without thickness have no feet"
        )
    if base.base != "direct":
        raise JobError(
            f"cells.base = {base.base!r} needs a cell with thickness; walls without thickness have no feet"
        )


class _SupportBuilder(NamedTuple):
    """Builds the bodies of support groups.

    Attributes
    ----------
    context
        Data that all groups share.
    parts
        Placed parts of the build.
    instances, as_beams
        Answers of the cell: all cells as meshes; and the answer with beams, if the cell makes any.
    rules
        Rules for the bodies.
    """

    context: SupportContext
    parts: tuple[PlacedPart, ...]
    instances: CellInstances
    as_beams: CellInstances | None
    rules: SolidRules

    def drained_solid(self, group: int) -> "Manifold | None":
        """Return the solid of a group, with drain holes where the cell promises them; its pieces may float.

        What is thinner than the least section is cut away. None where walls, parts and borders leave nothing.
        """
        solid, diameter = solid_of(self.context, group, self.instances), self.instances.cells.hole
        if solid is None or solid.is_empty():
            return None
        holes = NO_HOLES
        if diameter > 0.0:
            held = [self.parts[part].mesh for part in self.context.layout.group_parts[group]]
            solid, holes = cut_drain_holes(solid, held, diameter, self.context.foot_boxes(group))
        if self.rules.least is None:
            return solid
        near, tip_height = self.context.obstacles.near(solid), self._tip_height()
        solid = without_thin_rests(solid, near, self.rules.least, tip_height, holes)
        return None if solid.is_empty() else solid

    def finished_bodies(self, names: Sequence[str], group: int) -> list[SupportBody]:
        """Return the bodies of a group that has no base."""
        return self.bodies(group, names[group], self.drained_solid(group), None)

    def _tip_height(self) -> float:
        """Return the height (mm) below parts up to which connectors taper; 0 where they do not."""
        connector = self.rules.connector
        if not connector.is_shaped:
            return 0.0
        neck = self.context.layout.grid.pitch if connector.neck_mm else 0.0
        return connector.tip_height_mm + neck

    def bodies(
        self, group: int, name: str, solid: "Manifold | None", base: "Manifold | None"
    ) -> list[SupportBody]:
        """Return the bodies of a group: its solid with its base, and its walls without thickness."""
        held, found = self.context.layout.group_parts[group], []
        whole = self._holding(stored_solid(solid, base, self.context.foot_boxes(group)), held)
        sheet = sheet_of(self.context, group, self.instances) if self.instances.sheet.any() else None
        if whole is not None:
            lattice = None
            if self.as_beams is not None and self.rules.space is not None:
                lattice = self._lattice(group, self.as_beams, whole, base, self.rules.space)
            found.append(SupportBody(f"supports of {name}", whole, held, lattice=lattice))
        if sheet is not None and len(sheet.triangles):
            kind = "walls" if solid else "supports"
            found.append(SupportBody(f"{kind} of {name}", sheet, held, surface=True))
        return found

    def _holding(self, whole: Mesh | None, held: tuple[int, ...]) -> Mesh | None:
        """Return a solid without the pieces that touch none of the parts it holds; None where nothing is left."""
        parts = [self.parts[part] for part in held]
        if whole is None or not all(each.part.is_solid for each in parts):
            return whole
        kept = Mesh(*drop_idle(*whole.arrays, [each.mesh for each in parts]))
        return kept if len(kept.triangles) else None

    def _lattice(
        self, group: int, as_beams: CellInstances, whole: Mesh, base: "Manifold | None", space: BuildVolume
    ) -> Lattice | None:
        """Return the beams of a group with their connectors; None where they carry less than the solid does."""
        context, held = self.context, self.context.layout.group_parts[group]
        own = beams_of_group(as_beams.cells, group)
        beams = clip_beams(own, self.parts, held, space, overlap=context.overlap, gap=self.rules.gap)
        coarse, feet = None, context.foot_boxes(group)
        if len(whole.triangles) > MAX_STAND_IN_TRIANGLES:
            prisms = classify(as_beams.request, whole_prisms(as_beams.request))
            coarse = stored_solid(solid_of(context, group, prisms), base, feet)
        solids = stored_solid(solid_of(context, group, as_beams, on_beams=True), base, None)
        return lattice_of(beams, solids, whole, coarse, feet, space)
