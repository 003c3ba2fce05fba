"""The arrays that the kernels of G-code fill, and the table of known lines that they ask."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bytes, Floats
from amprep.errors import InputError
from amprep.kernels.gcode.records import (
    COLUMNS,
    HALF_WIDTH,
    MOST_CHORDS,
    OTHER,
    ROLE,
    ROLES,
    UNIT,
    UNKNOWN,
    KnownLines,
    Machine,
    Tracks,
)

_PLACES = 1 << 16
MOST_LINES = _PLACES // 2
"""Most different labels and features of a file."""
_SEGMENTS = 1 << 16


def new_machine(half_width: float, *, has_features: bool) -> Machine:
    """Return a machine at its origin, in millimetres and absolute modes.

    Where features are stated, what comes before the first of them is no part of an object.
    """
    machine = Machine(np.zeros(11), np.zeros(7), np.zeros(5, np.int64))
    machine.at[UNIT], machine.at[HALF_WIDTH] = 1.0, half_width
    machine.modes[ROLE] = OTHER if has_features else UNKNOWN
    return machine


def new_tracks(slots: int, heights: Floats) -> Tracks:
    """Return empty tracks of some slots."""
    rows = 2 * slots
    extent = np.tile([np.inf, np.inf, np.inf, -np.inf, -np.inf, -np.inf], (rows, 1))
    return Tracks(
        extent, np.zeros((rows, ROLES)), np.zeros((rows, 3)), np.zeros((rows, 3), np.int64), heights
    )


def with_room(tracks: Tracks, slots: int) -> Tracks:
    """Return tracks with at least so many slots; they are doubled where necessary."""
    if 2 * slots <= len(tracks.counts):
        return tracks
    more = new_tracks(len(tracks.counts) // 2, tracks.heights)
    return Tracks(
        np.concatenate([tracks.extent, more.extent]),
        np.concatenate([tracks.length, more.length]),
        np.concatenate([tracks.layer, more.layer]),
        np.concatenate([tracks.counts, more.counts]),
        tracks.heights,
    )


def new_segments() -> Floats:
    """Return the room for the lines of recorded layers, with room for an arc beyond."""
    return np.empty((_SEGMENTS + MOST_CHORDS, COLUMNS))


def new_table(prefixes: Sequence[str], width_prefixes: Sequence[str]) -> KnownLines:
    """Return an empty table for lines that begin with some prefixes."""
    return KnownLines(
        np.zeros(_PLACES, np.uint64),
        np.zeros(_PLACES, np.int64),
        np.zeros(_PLACES, np.int64),
        _padded(prefixes),
        _padded(width_prefixes),
    )


def require_room(count: int) -> None:
    """Raise InputError if a file has too many different labels."""
    if count >= MOST_LINES:
        raise InputError(f"the G-code has more than {MOST_LINES} different labels of objects and features")


def _padded(prefixes: Sequence[str]) -> Bytes:
    table = np.zeros((len(prefixes), max(map(len, prefixes))), np.uint8)
    for row, prefix in zip(table, prefixes, strict=True):
        row[: len(prefix)] = np.frombuffer(prefix.encode(), np.uint8)
    return table
