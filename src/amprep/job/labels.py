"""Read the list of labels: a CSV file that says which copy of which part gets which text."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal, cast, get_args

from amprep.errors import JobError, nearest_hint
from amprep.geometry.labels.faces import NAMES
from amprep.geometry.labels.font import unknown_in
from amprep.validation import require_bounds

LabelKind = Literal["engraved", "raised"]
COLUMNS = ("part", "copy", "text", "kind", "face", "x_mm", "y_mm", "height_mm", "depth_mm")

_LARGEST_FILE = 1 << 20
_MOST_ROWS = 10_000
_LONGEST_TEXT = 40


@dataclass(frozen=True)
class LabelSettings:
    """A row of the list of labels.

    Attributes
    ----------
    row
        Its number in the file, as a spreadsheet counts: the heading and empty rows are counted.
    part
        Name of the part; ``*`` and ``?`` stand for any characters.
    text
        What is written; ``{part}``, ``{copy}`` and ``{copies}`` stand for the name, the number and the count.
    copy
        Number of the copy, from 1; None for every copy.
    kind
        Whether the text is engraved or raised.
    face
        Direction in which the face looks; None for the largest face that holds the text.
    place
        Middle of the text from the middle of the face, to the right and upwards, mm; None for the nearest free place.
    height_mm, depth_mm
        Height of the letters, and how deep or high they are.
    """

    row: int
    part: str
    text: str
    copy: int | None = None
    kind: LabelKind = "engraved"
    face: str | None = None
    place: tuple[float, float] | None = None
    height_mm: float = 4.0
    depth_mm: float = 0.4

    def __post_init__(self) -> None:
        require_bounds(self, "height_mm", at_least=2, at_most=100)
        require_bounds(self, "depth_mm", at_least=0.1, at_most=5)
        require_bounds(self, "copy", at_least=1)

    def text_for(self, part: str, copy: int, copies: int) -> str:
        """Return the text for a copy of a part."""
        values = {"{part}": part, "{copy}": str(copy), "{copies}": str(copies)}
        text = self.text
        for name, value in values.items():
            text = text.replace(name, value)
        return text

    def is_for(self, part: str, copy: int) -> bool:
        """Tell whether a copy of a part gets this label."""
        return fnmatchcase(part, self.part) and self.copy in (None, copy)

    @property
    def differs(self) -> bool:
        """Whether the copies of a part get different labels."""
        return self.copy is not None or "{copy}" in self.text


def read_labels(path: Path) -> tuple[LabelSettings, ...]:
    """Read a list of labels.

    Raises
    ------
    JobError
        If the file cannot be read, or a row is wrong; the message names the row and the column.
    """
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise JobError(f"{path}: a list of labels must have at most {_LARGEST_FILE >> 20} MiB")
        text = path.read_text(encoding="utf-8-sig")
        rows = csv.reader(io.StringIO(text), delimiter=_delimiter(text), strict=True)
        filled = _filled(rows, path)
        heading = _heading(next(filled, (1, []))[1], path)
        found = [_label(heading, cells, number, f"{path}: row {number}") for number, cells in filled]
    except OSError as error:
        raise JobError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise JobError(f"{path}: not a CSV file in UTF-8 ({error})") from error
    return tuple(found)


def _filled(rows: Iterable[list[str]], path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the rows that are not empty, with their numbers as a spreadsheet counts them."""
    for number, row in enumerate(rows, start=1):
        if number > _MOST_ROWS:
            raise JobError(f"{path}: a list of labels must have at most {_MOST_ROWS} rows")
        cells = [cell.strip() for cell in row]
        if any(cells):
            yield number, cells


def _delimiter(text: str) -> str:
    """Return the sign between columns: a semicolon where the first line that is not empty has one."""
    return ";" if ";" in text.lstrip().partition("\n")[0] else ","


def _heading(names: list[str], path: Path) -> list[str]:
    while names and not names[-1]:  # spreadsheets write empty columns
        names = names[:-1]
    for name in names:
        if name not in COLUMNS:
            raise JobError(f"{path}: unknown column {name[:40]!r}{nearest_hint(name, COLUMNS)}")
        if names.count(name) > 1:
            raise JobError(f"{path}: the heading has the column {name} {names.count(name)} times; keep one")
    if not {"part", "text"} <= set(names):
        raise JobError(
            f"{path}: expected a heading with the columns part and text, got {', '.join(names)[:80] or 'none'}"
        )
    return names


def _label(heading: list[str], cells: list[str], number: int, where: str) -> LabelSettings:
    if any(cells[len(heading) :]):
        raise JobError(f"{where}: it has more columns than the heading")
    given = {name: cell for name, cell in zip(heading, cells, strict=False) if cell}
    if "part" not in given or "text" not in given:
        raise JobError(f"{where}: part and text must not be empty")
    _check_text(given["text"], where)
    face, kind = given.get("face"), given.get("kind", "engraved")
    if face not in (None, *NAMES):
        raise JobError(f"{where}: face: expected one of {', '.join(NAMES)}, got {face!r}")
    if kind not in get_args(LabelKind):
        raise JobError(f"{where}: kind: expected engraved or raised, got {kind!r}")
    sizes = {name: _number(given, name, where) for name in ("height_mm", "depth_mm") if name in given}
    place = None
    if "x_mm" in given or "y_mm" in given:
        place = tuple(_number(given, name, where) if name in given else 0.0 for name in ("x_mm", "y_mm"))
    try:
        return LabelSettings(
            number,
            given["part"],
            given["text"],
            _copy(given, where),
            cast("LabelKind", kind),
            face,
            cast("tuple[float, float] | None", place),
            **sizes,
        )
    except ValueError as error:
        raise JobError(f"{where}: {error}") from error


PLACEHOLDERS = ("{part}", "{copy}", "{copies}")
"""What stands in a text for the name of its part, the number of the copy and their count."""


def _check_text(text: str, where: str) -> None:
    if len(text) > _LONGEST_TEXT:
        raise JobError(f"{where}: text must have at most {_LONGEST_TEXT} characters, got {len(text)}")
    plain = text
    for placeholder in PLACEHOLDERS:
        plain = plain.replace(placeholder, "")
    if "{" in plain or "}" in plain:
        raise JobError(f"{where}: unknown placeholder in {text!r}; known are {', '.join(PLACEHOLDERS)}")
    unknown = unknown_in(plain)
    if unknown:
        raise JobError(f"{where}: the font has no {unknown!r}; it has letters, digits and - _ / . : + #")


def _copy(given: Mapping[str, str], where: str) -> int | None:
    text = given.get("copy")
    if text is None:
        return None
    if not (text.isascii() and text.isdecimal()) or len(text) > 9:
        raise JobError(f"{where}: copy: expected a whole number, got {text[:40]!r}")
    return int(text)


def _number(given: Mapping[str, str], name: str, where: str) -> float:
    try:
        value = float(given[name])
    except ValueError:
        value = float("nan")
    if not abs(value) <= 1e6:
        raise JobError(f"{where}: {name}: expected a number, got {given[name][:40]!r}")
    return value
