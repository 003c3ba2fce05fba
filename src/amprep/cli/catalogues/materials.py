"""``amprep materials``: list the materials that a job can name, with their limits and the sources of these."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from amprep.cli.catalogues.profiles import ProfileCommands

if TYPE_CHECKING:
    from amprep.materials.catalogue import Material


def _listed() -> "tuple[list[Material], list[str]]":
    from amprep.materials.catalogue import list_materials

    return list_materials()


def _find(name: str) -> "Material":
    from amprep.materials.catalogue import material_called

    return material_called(name)


def _record(material: "Material") -> dict[str, Any]:
    values = asdict(material.profile)
    first = ("name", "aliases", "based_on", "density_g_cm3")
    return {**{key: values[key] for key in first}, **values, "origin": material.origin}


def _print_table(materials: "list[Material]") -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from amprep.materials.catalogue import DEFAULT_MATERIALS

    table = Table(box=None)
    table.add_column("name", no_wrap=True)
    for heading in ("g/cm3", "ledge mm", "bridge mm", "bore mm", "layer mm", "mm2/s"):
        table.add_column(heading, justify="right", no_wrap=True)
    sources = Table(box=None, show_header=False)
    sources.add_column(no_wrap=True)
    for material in materials:
        profile = material.profile
        default = " [dim](default)" if profile.name in DEFAULT_MATERIALS.values() else ""
        origin = "" if material.origin == "built-in" else f"[dim]{material.origin}[/] "
        table.add_row(
            escape(profile.name) + default,
            "-" if profile.density_g_cm3 is None else f"{profile.density_g_cm3:g}",
            *map(_limit, (profile.ledge_mm, profile.bridge_mm, profile.bore_mm)),
            f"{profile.layer_mm:g}",
            f"{profile.scan_mm2_s:g}",
        )
        sources.add_row(escape(profile.name), origin + escape(profile.source))
    Console().print(table, "", "Sources:", sources)


def _limit(value: float) -> str:
    from amprep.model.supports.rules import LARGEST_LIMIT

    return "any" if value >= LARGEST_LIMIT else f"{value:g}"


app = ProfileCommands(
    kind="material",
    about="List all materials with their limits for overhangs, density, layer height and speed.",
    listed=_listed,
    find=_find,
    record=_record,
    unstated=("origin", "based_on"),  # every key is stated, also what comes from the base
    print_table=_print_table,
).app()
