"""The ways in which slicers label the moves of objects."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Dialect:
    """One way to label objects.

    Attributes
    ----------
    words
        How messages call these labels.
    prefixes
        Beginnings of the lines that are labels.
    begin
        Pattern of a line that begins an object; its group is the name.
    end
        Pattern of a line that ends one.
    has_names
        Whether the names are those of the objects, rather than numbers.
    """

    words: str
    prefixes: tuple[str, ...]
    begin: re.Pattern[str]
    end: re.Pattern[str]
    has_names: bool = True

    def name_in(self, line: str) -> str | None:
        """Return the name of the object that a label begins, "" where it ends an object, None if it does neither."""
        if self.end.match(line):
            return ""
        found = self.begin.match(line)
        return None if found is None else found[1].strip()


DIALECTS = (
    Dialect(
        "comments 'printing object'",
        ("; printing object ", "; stop printing object "),
        re.compile(r"; printing object (.+)"),
        re.compile(r"; stop printing object (?!, unique)"),
    ),
    Dialect(
        "EXCLUDE_OBJECT_START",
        ("EXCLUDE_OBJECT_START", "EXCLUDE_OBJECT_END"),
        re.compile(r"EXCLUDE_OBJECT_START\s+NAME=['\"]?([^'\"]+)"),
        re.compile(r"EXCLUDE_OBJECT_END"),
    ),
    Dialect(
        "comments ';MESH:'",
        (";MESH:",),
        re.compile(r";MESH:(.+)"),
        re.compile(r";MESH:NONMESH"),
    ),
    Dialect(
        "M486",
        ("M486",),
        re.compile(r"M486\s+S(\d+)"),
        re.compile(r"M486\s+S-1"),
        has_names=False,
    ),
    Dialect(
        "comments 'unique label id'",
        ("; start printing object", "; stop printing object"),
        re.compile(r"; start printing object, unique label id: (\d+)"),
        re.compile(r"; stop printing object"),
        has_names=False,
    ),
    Dialect(
        "M624",
        ("M624", "M625"),
        re.compile(r"M624\s+(\S+)"),
        re.compile(r"M625"),
        has_names=False,
    ),
)
"""From the most telling to the least: the first that occurs in a file is read."""

_M486_NAME = re.compile(r"^M486 S(\d+)[^\n]*\nM486 A(.+?)\r?$", re.MULTILINE)


def dialect_of(head: str) -> Dialect | None:
    """Return the labels that a file uses by its beginning, None if it has none."""
    lines = head.splitlines()
    for dialect in DIALECTS:
        if any(line.startswith(dialect.prefixes) and dialect.name_in(line) for line in lines):
            return dialect
    return None


def names_of_numbers(head: str) -> dict[str, str]:
    """Return the names that the beginning of a file gives to the numbers of M486."""
    return dict(_M486_NAME.findall(head))
