"""What a slicer tells the scripts that it runs after slicing, in variables of the environment."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_HOST, _OUTPUT = "SLIC3R_PP_HOST", "SLIC3R_PP_OUTPUT_NAME"
_FILE = "File"


@dataclass(frozen=True)
class Destination:
    """Where the slicer will put the G-code.

    Attributes
    ----------
    host
        ``File``, or the kind of print server; "" if no slicer runs the script.
    output
        Path of the finished file, None if it goes to a print server.
    name
        Name of the finished file.
    """

    host: str
    output: Path | None
    name: str


def destination_of(gcode: Path, environment: Mapping[str, str]) -> Destination:
    """Return where a file of G-code goes; it stays where it is if no slicer runs the script."""
    host, output = environment.get(_HOST, ""), environment.get(_OUTPUT, "")
    if host and host != _FILE:
        return Destination(host, None, Path(output).name or gcode.name)
    path = Path(output) if output else gcode
    return Destination(host, path, path.name)
