"""What the user chooses in the settings dialog, and the arguments that follow from it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Any, Callable, Mapping

PREFIX = "amprep/"
"""Before the names of the settings among Cura's preferences."""


def _setting(default: str, label: str, hint: str) -> Any:
    return field(default=default, metadata={"label": label, "hint": hint})


@dataclass(frozen=True)
class Settings:
    """The settings of the plugin; an empty text leaves a choice to amprep.

    Attributes
    ----------
    program
        Name or path of the program amprep.
    printer
        Name of a printer of amprep; empty for the bed of Cura's active machine.
    folder
        Folder for the files; empty for the folder ``amprep`` in the home of the user.
    """

    program: str = _setting("amprep", "Program", "amprep, or its full path")
    printer: str = _setting("", "Printer", "the active machine of Cura")
    packer: str = _setting("", "Packer", "chosen by amprep")
    cell: str = _setting("", "Support cell", "chosen by amprep")
    material: str = _setting("", "Material", "by printer")
    folder: str = _setting("", "Folder for files", "the folder amprep in your home folder")


DEFAULTS = asdict(Settings())


def settings_from(value_of: Callable[[str], Any]) -> Settings:
    """Return the settings that Cura's preferences contain, without blanks around them.

    Parameters
    ----------
    value_of
        Returns the value of a preference by its full name, or None.
    """
    return Settings(
        **{key: str(value_of(PREFIX + key) or default).strip() for key, default in DEFAULTS.items()}
    )


def rows_of(settings: Settings) -> list[dict[str, str]]:
    """Return the rows of the dialog: key, label, hint and present value."""
    values = asdict(settings)
    return [{"key": each.name, "value": values[each.name], **each.metadata} for each in fields(Settings)]


def import_arguments(settings: Settings, definition: str, folder: str) -> list[str]:
    """Return the command that makes amprep's profile of a printer from a definition of Cura."""
    return [settings.program, "printers", "import", definition, "-o", folder, "--force", "--json"]


def run_arguments(settings: Settings, plate: str, folder: str, name: str, printer: str) -> list[str]:
    """Return the command that prepares a plate.

    Parameters
    ----------
    plate
        The 3MF file with the models.
    folder
        Folder for the files.
    name
        Name of the job.
    printer
        Name or profile of the printer.
    """
    options = {"-o": folder, "--name": name, "--printer": printer, **_chosen(settings)}
    pairs = [word for pair in options.items() for word in pair]
    return [settings.program, "run", plate, "--for", "cura", "--json", "--progress", "lines", *pairs]


def _chosen(settings: Settings) -> Mapping[str, str]:
    """Return the options that the user chose."""
    options = {"--packer": settings.packer, "--cell": settings.cell, "--material": settings.material}
    return {option: value for option, value in options.items() if value}
