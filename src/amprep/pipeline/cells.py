"""From a support layout to finished bodies: cells for the edges, connectors up to the faces, all united."""

from amprep.errors import JobError
from amprep.model import PlacedPart, Report, Stop, SupportBody
from amprep.pipeline.cell_carving import Obstacles
from amprep.pipeline.cell_connectors import find_ways
from amprep.pipeline.cell_groups import sheet_of, solid_of, sort_out
from amprep.pipeline.cell_requests import Emit, checked, make_request
from amprep.pipeline.support_layout import SupportLayout


def build_supports(
    layout: SupportLayout,
    parts: tuple[PlacedPart, ...],
    emit: Emit,
    *,
    overlap: float,
    connector: str,
    allow_surface: bool,
    stop: Stop,
    report: Report,
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
        ``full``: the whole square runs up; ``extend``: the cell does, as walls without thickness always do.
    allow_surface
        Whether the target reads walls without thickness.
    stop
        Only asked between groups; what is not finished by then is left out.

    Raises
    ------
    PluginError
        When the cell's answer does not fit the request.
    JobError
        When the cell cannot be made in this grid.
    """
    if not len(layout.red) or not layout.connected.any():
        return ()
    report(0.0, "emitting cells")
    meshes = tuple(part.mesh for part in parts)
    request = make_request(
        layout, meshes, overlap=overlap, allow_surface=allow_surface, extend=connector == "extend"
    )
    cells = checked(request, emit(request))
    if connector != "extend" and any(template.surface for template in cells.templates):
        request = make_request(layout, meshes, overlap=overlap, allow_surface=allow_surface, extend=True)
        cells = checked(request, emit(request))
    emitted = sort_out(request, cells)
    if emitted.sheet.any() and len(layout.feet):
        raise JobError(
            "supports.grounding = 'anywhere' needs a cell with thickness: walls without any have no feet"
        )
    ways, obstacles = find_ways(layout, layout.meshes), Obstacles(parts)
    bodies: list[SupportBody] = []
    count = len(layout.group_parts)
    for group, held in enumerate(layout.group_parts):
        if stop.cancelled.is_set():
            break
        name = ", ".join(parts[part].label for part in held)
        report(group / count, f"uniting supports of {name}")
        solid = solid_of(
            group, emitted, layout, ways, obstacles, overlap=overlap, extend=connector == "extend"
        )
        sheet = sheet_of(group, emitted, layout, ways, overlap=overlap) if emitted.sheet.any() else None
        if solid is not None and len(solid.triangles):
            bodies.append(SupportBody(f"supports of {name}", solid, held))
        if sheet is not None and len(sheet.triangles):
            bodies.append(
                SupportBody(f"{'walls' if solid else 'supports'} of {name}", sheet, held, surface=True)
            )
    report(1.0, "supports finished")
    return tuple(bodies)
