"""Lines, numbers and beginnings in blocks of bytes."""

from amprep.arrays import Bytes
from amprep.kernels.helper import inlined

BLANK, TAB, RETURN, NEWLINE = 32, 9, 13, 10


@inlined
def line_end(text: Bytes, start: int, end: int) -> int:
    """Return the index of the next line feed, -1 if there is none before `end`."""
    for i in range(start, end):
        if text[i] == NEWLINE:
            return i
    return -1


@inlined
def skip_blanks(text: Bytes, start: int, end: int) -> int:
    """Return the index of the next byte that is no blank."""
    i = start
    while i < end and (text[i] == BLANK or text[i] == TAB or text[i] == RETURN):
        i += 1
    return i


@inlined
def number(text: Bytes, start: int, end: int) -> tuple[float, int]:
    """Return a decimal number without exponent, and the index after it; 0 and `start` if there is none."""
    i = start
    negative = i < end and text[i] == ord("-")
    if i < end and (negative or text[i] == ord("+")):
        i += 1
    digits, scale, fraction, count = 0.0, 1.0, False, 0
    while i < end:
        c = text[i]
        if 48 <= c <= 57:
            digits = digits * 10.0 + (c - 48)
            count += 1
            if fraction:
                scale *= 10.0
        elif c == ord(".") and not fraction:
            fraction = True
        else:
            break
        i += 1
    if count == 0:
        return 0.0, start
    value = digits / scale
    return (-value if negative else value), i


@inlined
def begins_with(text: Bytes, start: int, end: int, prefix: Bytes) -> int:
    """Return the index after a prefix that is padded with zeros, -1 if the text does not begin with it."""
    i = start
    for p in prefix:
        if p == 0:
            break
        if i >= end or text[i] != p:
            return -1
        i += 1
    return i
