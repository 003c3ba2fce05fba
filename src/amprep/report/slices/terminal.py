"""The slices of a build as a table."""

from typing import TYPE_CHECKING

from amprep.report.slices.record import SliceRecord

if TYPE_CHECKING:
    from rich.console import RenderableType


def summary(record: SliceRecord) -> "RenderableType":
    """Return a table of the bodies."""
    from rich.console import Group
    from rich.markup import escape
    from rich.table import Table

    title = f"{record.build}: {record.layers} layers of {record.layer_mm:g} mm"
    table = Table(
        "body",
        "",
        "contours",
        "volume cm³",
        "sliced cm³",
        "lines m",
        title=escape(title),
        title_justify="left",
    )
    for each in record.bodies:
        sliced = float(each.area_mm2.sum()) * record.layer_mm
        table.add_row(
            escape(each.name),
            each.role,
            str(each.contours),
            f"{each.volume_mm3 / 1000:.3f}",
            f"{sliced / 1000:.3f}",
            f"{each.lines_mm / 1000:.2f}" if each.lines_mm else "",
        )
    first, last = record.files[0], record.files[-1]
    more = "" if first == last else f" to {last} ({len(record.files)} files)"
    lines: list[RenderableType] = [table, f"wrote {escape(str(record.folder / first))}{escape(more)}"]
    if any(each.has_beams for each in record.bodies):
        lines.append("Beams are sliced as the mesh that stands for them; it may be coarser.")
    return Group(*lines)
