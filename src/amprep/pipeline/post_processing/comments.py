"""Write a summary as comments into a file of G-code."""

import shutil
from collections.abc import Sequence
from pathlib import Path

from amprep.files import replacing

MARK = "; amprep "
"""Beginning of every comment that amprep writes."""
_HEAD = 8 << 20
_COPIED = 4 << 20


def write_comments(gcode: Path, lines: Sequence[str]) -> None:
    """Insert comments before the first command of a file; those of an earlier run are replaced.

    The first lines of the file, its pictures and its settings stay as they are, because slicers and printers read them.
    The file is written beside the old one and takes its place when it is complete.

    Parameters
    ----------
    lines
        The comments, without their beginning.

    Raises
    ------
    AmprepError
        If the file cannot be written.
    """
    comments = "".join(f"{MARK}{' '.join(line.split())}\n" for line in lines).encode()
    with replacing(gcode) as temporary, gcode.open("rb") as old, temporary.open("wb") as new:
        head = old.read(_HEAD)
        place = _first_command(head)
        new.write(_without_own(head[:place]))
        new.write(comments)
        new.write(head[place:])
        shutil.copyfileobj(old, new, _COPIED)
        shutil.copymode(gcode, temporary)


def _first_command(head: bytes) -> int:
    """Return where the first line begins that is neither empty nor a comment; 0 if there is none."""
    place = 0
    for line in head.splitlines(keepends=True):
        if line.strip() and not line.lstrip().startswith(b";"):
            return place
        place += len(line)
    return 0 if len(head) == _HEAD else place


def _without_own(head: bytes) -> bytes:
    """Return lines without the comments of an earlier run; the last line ends with a line feed."""
    kept = [line for line in head.splitlines(keepends=True) if not line.startswith(MARK.encode())]
    text = b"".join(kept)
    return text if not text or text.endswith(b"\n") else text + b"\n"
