"""``amprep printers``: list the printers that a job can name, with the sources of their sizes."""

from typing import TYPE_CHECKING, Any

from amprep.cli.catalogues.fitted_material import fit
from amprep.cli.catalogues.imported_printers import import_printers
from amprep.cli.catalogues.profiles import ProfileCommands

if TYPE_CHECKING:
    from amprep.printers.catalogue import Printer


def _listed() -> "tuple[list[Printer], list[str]]":
    from amprep.printers.catalogue import list_printers

    return list_printers()


def _find(name: str) -> "Printer":
    from amprep.printers.catalogue import find_printer

    return find_printer(name)


def _record(printer: "Printer") -> dict[str, Any]:
    space = printer.space
    size = space.size.tolist() if space.shape == "box" else space.size.tolist()[1:]
    zones = [[*lo, *hi] for lo, hi in zip(space.zone_lo.tolist(), space.zone_hi.tolist(), strict=True)]
    return {
        "name": printer.name,
        "technology": printer.technology,
        "shape": space.shape,
        "size_mm": size,
        "zones": zones,
        "origin_mm": list(printer.plate_origin),
        "recoater_deg": printer.recoater_deg,
        "gas_flow_deg": printer.gas_flow_deg,
        "source": printer.source,
        "origin": printer.origin,
    }


def _print_table(printers: "list[Printer]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.printers.catalogue import DEFAULT_PRINTER
    from amprep.profiles import normalised

    table = Table("name", "build volume (mm)", "technology", "source", box=None)
    for printer in printers:
        default = " [dim](default)" if normalised(printer.name) == normalised(DEFAULT_PRINTER) else ""
        origin = "" if printer.origin == "built-in" else f"[dim]{printer.origin}[/] "
        source = origin + escape(printer.source)
        table.add_row(escape(printer.name) + default, _size(printer), printer.technology, source)
    Console().print(table)


def _size(printer: "Printer") -> str:
    x, y, z = (f"{value:g}" for value in printer.space.size.tolist())
    zones = len(printer.space.zone_lo)
    shape = f"{x} x {y} x {z}" if printer.space.shape == "box" else f"diameter {x}, height {z}"
    return shape + (f", {zones} forbidden zone{'s' if zones > 1 else ''}" if zones else "")


app = ProfileCommands(
    kind="printer",
    about="List all printers with their build volumes and the sources of their sizes.",
    listed=_listed,
    find=_find,
    record=_record,
    unstated=("origin",),
    print_table=_print_table,
    more="show one, import those of a slicer, or fit one to the log of a build",
).app()
app.command("import")(import_printers)
app.command("fit")(fit)
