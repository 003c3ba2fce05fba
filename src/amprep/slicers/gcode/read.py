"""Read a file of G-code in constant memory: what it extrudes for each object."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from amprep.arrays import Bytes, Floats
from amprep.checks.gcode.found import SlicedBody, SlicedObject, SlicedPlate
from amprep.errors import InputError
from amprep.slicers.gcode.dialects import Dialect, dialect_of, names_of_numbers
from amprep.slicers.gcode.features import FEATURE_PREFIXES, role_of
from amprep.slicers.gcode.samples import LayerSamples
from amprep.slicers.gcode.settings import bed_of, half_width_of, program_of, settings_in
from amprep.slicers.gcode.tables import (
    new_machine,
    new_segments,
    new_table,
    new_tracks,
    require_room,
    with_room,
)

_HEAD = 8 << 20
"""The first bytes in which labels and settings are searched."""
_TAIL = 1 << 20
_COMMAND = re.compile(r"^\s*(?:N\d+\s+)?[GMT]\d", re.MULTILINE | re.IGNORECASE)
_BLOCK = 4 << 20
_BINARY = b"GCDE"
_WIDTHS = (";WIDTH:", "; LINE_WIDTH:")
_BEFORE = re.compile(rb"[ \t\r]*(?:[Nn][-+]?\d*\.?\d*[ \t\r]*)?")
"""What a line may have before its command."""
_LONGEST_LABEL = 1 << 16
_FARTHEST = 1e6
"""Largest coordinate (mm) that a printer may have."""
_NUMBERS = re.compile(r"(?:\s+id:\s*\d+)?(?:\s+copy\s+\d+)?$|_id_\d+_copy_\d+$")


@dataclass(frozen=True, eq=False)
class GcodeHead:
    """What the beginning and the end of a file say.

    Attributes
    ----------
    program
        The slicer; "" if it is not stated.
    dialect
        How objects are labelled; None if they are not.
    settings
        The settings of the slicer by name.
    names
        Name of each object by its number, where M486 states them.
    label_text
        The labels in the beginning, for the search of identifiers.
    has_features
        Whether features are stated.
    """

    program: str
    dialect: Dialect | None
    settings: dict[str, str]
    names: dict[str, str]
    label_text: str
    has_features: bool


def read_head(path: Path) -> GcodeHead:
    """Read the beginning and the end of a file.

    Raises
    ------
    InputError
        If it cannot be read, is binary, or has no command of G-code.
    """
    with _opened(path) as file:
        head = file.read(_HEAD)
        size = file.seek(0, 2)
        file.seek(max(size - _TAIL, 0))
        tail = file.read(_TAIL)
    if head.startswith(_BINARY):
        raise InputError(
            f"{path}: binary G-code cannot be read; turn binary G-code off in the printer's settings"
        )
    if b"\0" in head:
        raise InputError(f"{path}: not G-code, but a binary file")
    text = head.decode("utf-8", "replace")
    if not _COMMAND.search(text):
        raise InputError(f"{path}: not G-code: no line begins with a command such as G1")
    dialect = dialect_of(text)
    return GcodeHead(
        program_of(text[:100_000]),
        dialect,
        settings_in(text) | settings_in(tail.decode("utf-8", "replace")),
        names_of_numbers(text),
        _label_text(text, dialect),
        any(f"\n{prefix}" in text or text.startswith(prefix) for prefix in FEATURE_PREFIXES),
    )


def read_gcode(path: Path, head: GcodeHead, heights: Floats) -> SlicedPlate:
    """Read what a file extrudes.

    Parameters
    ----------
    head
        What `read_head` returned.
    heights
        ``(k,)`` mm, ascending: for each object, the lines of the layer in which each height lies are kept.

    Raises
    ------
    InputError
        If the file cannot be read, has too many labels, a line too long, or coordinates that no printer has.
    """
    reader = _Reader(head, heights)
    with _opened(path) as file:
        try:
            reader.read(file)
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    if not reader.is_bounded:
        raise InputError(f"{path}: prints farther than {_FARTHEST / 1000:g} m from the origin")
    return reader.plate()


class _Reader:
    """Feeds blocks to the kernel and explains the labels and features that it meets for the first time."""

    def __init__(self, head: GcodeHead, heights: Floats) -> None:
        self.head = head
        prefixes = FEATURE_PREFIXES + (() if head.dialect is None else head.dialect.prefixes)
        self.machine = new_machine(half_width_of(head.settings), has_features=head.has_features)
        self.tracks = new_tracks(16, np.ascontiguousarray(heights, np.float64))
        self.table = new_table(prefixes, _WIDTHS)
        self.segments = new_segments()
        self.samples = LayerSamples()
        self.slots: dict[str, int] = {}
        self.learnt = 0

    def read(self, file: BinaryIO) -> None:
        """Read a file block by block; a line that a block cuts is read with the next one."""
        block = np.empty(2 * _BLOCK, np.uint8)
        kept = 0
        while count := file.readinto(block[kept : kept + _BLOCK].data):  # type: ignore[attr-defined]
            end = kept + count
            start = self._parse(block, end)
            kept = end - start
            if kept > _BLOCK:
                raise InputError(f"the G-code has a line of more than {_BLOCK >> 20} MiB")
            block[:kept] = block[start:end].copy()
        block[kept] = ord("\n")
        self._parse(block, kept + 1)
        self._keep_segments()

    def _parse(self, block: Bytes, end: int) -> int:
        """Read the whole lines of a block; return where the line begins that is not complete."""
        from amprep.kernels.gcode.parse import parse
        from amprep.kernels.gcode.records import MORE, UNKNOWN_LINE

        start = 0
        while True:
            start, why = parse(block, start, end, self.machine, self.tracks, self.table, self.segments)
            if why == MORE:
                return int(start)
            if why == UNKNOWN_LINE:
                self._explain(block, start, end)
            else:
                self._keep_segments()

    def _explain(self, block: Bytes, start: int, end: int) -> None:
        """Teach the table what the line does that begins here."""
        from amprep.kernels.gcode.lines import learn
        from amprep.kernels.gcode.records import FEATURE, NOTHING, OBJECT

        require_room(self.learnt)
        self.learnt += 1
        text, ending, _ = block[start : min(end, start + _LONGEST_LABEL)].tobytes().partition(b"\n")
        if not ending:
            raise InputError(f"the G-code has a label of more than {_LONGEST_LABEL >> 10} KiB")
        lead = len(_BEFORE.match(text)[0])  # type: ignore[index]
        line = text[lead:].decode("utf-8", "replace").strip()
        role = role_of(line)
        kind, value = NOTHING, 0
        if role is not None:
            kind, value = FEATURE, role
        elif self.head.dialect is not None:
            name = self.head.dialect.name_in(line)
            if name is not None:
                kind, value = OBJECT, self._slot(name)
        learn(block, start + lead, start + len(text), self.table, kind, value)

    def _slot(self, name: str) -> int:
        if not name:
            return 0
        slot = self.slots.setdefault(name, len(self.slots) + 1)
        self.tracks = with_room(self.tracks, slot + 1)
        return slot

    def _keep_segments(self) -> None:
        from amprep.kernels.gcode.records import SEGMENTS

        self.samples.add(self.segments[: self.machine.modes[SEGMENTS]])
        self.machine.modes[SEGMENTS] = 0

    @property
    def is_bounded(self) -> bool:
        """Whether all lines have coordinates that a printer may have."""
        printed = self.tracks.extent[self.tracks.counts[:, 0] > 0]
        return bool(np.all(np.abs(printed) <= _FARTHEST) and np.all(np.isfinite(self.tracks.length)))

    def plate(self) -> SlicedPlate:
        """Return what was read."""
        dialect, settings = self.head.dialect, self.head.settings
        apart = self._object("", 0)
        objects = [self._object(name, slot) for name, slot in self.slots.items()]
        return SlicedPlate(
            self.head.program,
            tuple(each for each in objects if not (each.body.is_empty and each.supports.is_empty)),
            "" if dialect is None else dialect.words,
            (dialect is not None and dialect.has_names) or bool(self.head.names),
            apart,
            bed_of(settings),
            settings,
            self.head.has_features,
        )

    def _object(self, label: str, slot: int) -> SlicedObject:
        numbered = self.head.dialect is not None and not self.head.dialect.has_names
        name = self.head.names.get(label, "") if numbered else _NUMBERS.sub("", label)
        return SlicedObject(name, self._body(2 * slot), self._body(2 * slot + 1), label if numbered else "")

    def _body(self, row: int) -> SlicedBody:
        from amprep.kernels.gcode.records import SUPPORT

        extent, layers = self.tracks.extent[row], int(self.tracks.counts[row, 0])
        length = float(self.tracks.length[row, : SUPPORT + 1].sum())
        thickest = float(self.tracks.layer[row, 2])
        return SlicedBody(extent[:3], extent[3:], length, layers, thickest, self.samples.of_row(row))


def _opened(path: Path) -> BinaryIO:
    try:
        return path.open("rb")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error


def _label_text(text: str, dialect: Dialect | None) -> str:
    """Return the different labels and definitions of objects in a text."""
    prefixes = ("EXCLUDE_OBJECT_DEFINE", "M486 A", *(() if dialect is None else dialect.prefixes))
    lines = (line for line in text.splitlines() if line.startswith(prefixes))
    return "\n".join(dict.fromkeys(lines))
