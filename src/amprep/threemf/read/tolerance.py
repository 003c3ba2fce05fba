"""What a reader does with a file that breaks rules: refuse it, warn, or read it without colours and materials."""

import io
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path

from amprep.errors import InputError
from amprep.threemf.read.arrays import LoadedModel, load_model
from amprep.threemf.rules import BrokenRule
from amprep.threemf.rules.schema import MATERIALS_NAMESPACE

MOST_WARNINGS = 10

_PROPERTIES = re.compile(
    rb"""\s(?:pid|pindex|p1|p2|p3|thumbnail|xml:space|xsi:\w+)\s*=\s*(?:"[^"<]*"|'[^'<]*')(?=[^<>]*>)"""
)
_BASE_MATERIALS = re.compile(
    rb"<(?P<name>(?:\w+:)?basematerials)\b(?:[^<>]*/>|[^<>]*>.*?</(?P=name)\s*>)", re.DOTALL
)

_TICKETS = re.compile(rb"<(?:\w+:)?Relationship\b[^<>]*/2013/01/printticket[^<>]*/>")


def refuse_broken(broken: Sequence[BrokenRule], path: Path, *, strict: bool) -> None:
    """Refuse a file for the first rule that it breaks, if that rule may touch its parts or the reader is strict.

    Raises
    ------
    InputError
        With the rule.
    """
    if broken and broken[0].touches_parts:
        raise InputError(f"{path}: breaks a rule of the format. {broken[0]}; export it again")
    if broken and strict:
        raise InputError(f"{path}: refused because reading is strict. {broken[0]}; export it again")


def warnings_of(broken: Sequence[BrokenRule], complaint: str) -> tuple[str, ...]:
    """Return a warning for each broken rule, and one for what lib3mf refused."""
    listed = [f"the file breaks a rule of the format. {each}" for each in broken[:MOST_WARNINGS]]
    if len(broken) > MOST_WARNINGS:
        listed.append(f"the file breaks {len(broken) - MOST_WARNINGS} more rules of the format")
    if complaint:
        listed.append(f"lib3mf refuses the file ({complaint}); it is read without colours and materials")
    return tuple(listed)


def load_tolerantly(data: bytes, path: Path) -> tuple[LoadedModel, str]:
    """Load a model, if necessary without its colours, materials, thumbnails and print tickets.

    Returns
    -------
    model, complaint
        The complaint is lib3mf's reason to refuse the whole model; empty if it did not.

    Raises
    ------
    InputError
        If lib3mf refuses what is left, too.
    """
    from lib3mf import Lib3MF

    try:
        return load_model(data), ""
    except Lib3MF.ELib3MFException as error:
        complaint = str(error).partition(": ")[2] or str(error)
    try:
        return load_model(_without_properties(data)), complaint
    except Lib3MF.ELib3MFException as error:
        reason = str(error).partition(": ")[2] or str(error)
        raise InputError(f"{path}: lib3mf refuses this file ({reason}); export it again") from error


def _without_properties(data: bytes) -> bytes:
    """Return a package without colours, materials, thumbnails of objects and print tickets; all else is as before."""
    packed = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(data)) as before,
        zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as after,
    ):
        for info in before.infolist():
            content, name = before.read(info), info.filename.lower()
            if name.endswith(".model"):
                content = _plain(content)
            elif name.endswith(".rels"):
                content = _TICKETS.sub(b"", content)
            after.writestr(info, content)
    return packed.getvalue()


def _plain(model: bytes) -> bytes:
    """Return a model part without properties of objects and triangles, and without their definitions."""
    for prefix in set(re.findall(rb"xmlns:(\w+)\s*=\s*[\"']%b" % MATERIALS_NAMESPACE.encode(), model)):
        groups = rb"<(?P<name>%b:\w+)\b(?:[^<>]*/>|[^<>]*>.*?</(?P=name)\s*>)" % prefix
        model = re.sub(groups, b"", model, flags=re.DOTALL)
    return _PROPERTIES.sub(b"", _BASE_MATERIALS.sub(b"", model))
