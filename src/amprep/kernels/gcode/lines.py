"""Look up lines in the table of known lines."""

import numpy as np

from amprep.arrays import Bytes
from amprep.kernels.gcode.records import KnownLines
from amprep.kernels.gcode.text import RETURN, begins_with
from amprep.kernels.helper import helper, kernel

_OFFSET, _PRIME = np.uint64(0xCBF29CE484222325), np.uint64(0x100000001B3)
"""Constants of the hash FNV-1a (RFC 9923)."""


@helper
def hash_of(text: Bytes, start: int, end: int) -> np.uint64:
    """Return the hash of a line without its carriage return; it is never 0."""
    if end > start and text[end - 1] == RETURN:
        end -= 1
    value = _OFFSET
    for i in range(start, end):
        value = (value ^ np.uint64(text[i])) * _PRIME
    return value if value != np.uint64(0) else _PRIME


@helper
def place_of(known: KnownLines, key: np.uint64) -> np.int64:
    """Return the place of a hash in the table, or the empty place where it belongs."""
    mask = len(known.key) - 1
    place = np.int64(key >> np.uint64(1)) & mask
    while known.key[place] != np.uint64(0) and known.key[place] != key:
        place = (place + 1) & mask
    return place


@helper
def matches(text: Bytes, start: int, end: int, prefixes: Bytes) -> int:
    """Return the index after the prefix with which a line begins, -1 if it begins with none of them."""
    for p in range(len(prefixes)):
        after = begins_with(text, start, end, prefixes[p])
        if after >= 0:
            return after
    return -1


@kernel
def learn(text: Bytes, start: int, end: int, known: KnownLines, kind: int, value: int) -> None:
    """Add a line to the table, which must have room."""
    key = hash_of(text, start, end)
    place = place_of(known, key)
    known.key[place], known.kind[place], known.value[place] = key, kind, value
