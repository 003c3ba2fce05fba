"""Find the build file that a file of G-code was made from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from amprep.errors import InputError
from amprep.slicers.gcode.read import GcodeHead
from amprep.threemf.build.identifier import identifiers_in, read_identifier

_MOST_FILES = 5000
"""Most files that are looked at in a folder and its subfolders."""


@dataclass(frozen=True)
class FoundBuild:
    """The build file of a file of G-code.

    Attributes
    ----------
    path
        The build file, None if there is none.
    words
        By what it was found, or why it was not.
    identifier
        The identifier in its metadata; "" in files of earlier versions.
    is_other
        Whether the names of objects state another build.
    """

    path: Path | None
    words: str
    identifier: str = ""
    is_other: bool = False


def find_build(
    head: GcodeHead, name: str, *, build: Path | None, folder: Path | None, beside: Sequence[Path]
) -> FoundBuild:
    """Return the build file of a file of G-code: a given one, or one that its names of objects state.

    Where no name states a build, a build file counts whose name begins that of the G-code.

    Parameters
    ----------
    head
        Beginning of the G-code.
    name
        Name of the finished file.
    build
        The build file, if the user states it.
    folder
        Where to search, subfolders included.
    beside
        Folders to search, without subfolders, if the user states neither.

    Raises
    ------
    InputError
        If the folder does not exist.
    """
    stated = identifiers_in(head.label_text)
    if build is not None:
        own = read_identifier(build) or ""
        other = bool(own) and bool(stated) and own not in stated
        return FoundBuild(build, "as --build states", own, other)
    files = list(_files(folder, beside))
    known = {path: identifier for path in files if (identifier := read_identifier(path))}
    for path, identifier in known.items():
        if identifier in stated:
            return FoundBuild(path, f"by the identifier {identifier} in the names of objects", identifier)
    named = [path for path in known if name.startswith(path.stem)]
    if len(named) == 1 and not stated:
        return FoundBuild(named[0], "by the name of the file", known[named[0]])
    return FoundBuild(None, _why(head, len(known), folder, beside))


def _files(folder: Path | None, beside: Sequence[Path]) -> Iterable[Path]:
    """Return the 3MF files to look at, each once, in the order of their names."""
    if folder is not None:
        if not folder.is_dir():
            raise InputError(f"{folder}: not a folder; --folder takes the folder of the build files")
        return sorted(islice(folder.rglob("*.3mf"), _MOST_FILES))
    places = dict.fromkeys(path.resolve() for path in beside if path.is_dir())
    return [path for place in places for path in sorted(islice(place.glob("*.3mf"), _MOST_FILES))]


def _why(head: GcodeHead, builds: int, folder: Path | None, beside: Sequence[Path]) -> str:
    """Return why no build was found, and what helps."""
    where = str(folder) if folder is not None else " and ".join(dict.fromkeys(map(str, beside)))
    if head.dialect is None:
        reason = "the objects are not labelled: turn 'Label objects' on in the slicer's output options"
    elif not head.dialect.has_names and not head.names:
        reason = "the labels of objects have numbers, not names"
    else:
        reason = f"no build file in {where} has an identifier that the names of objects contain"
    seen = "1 build file" if builds == 1 else f"{builds} build files"
    return f"{reason} ({seen} seen); give --build FILE or --folder DIR"
