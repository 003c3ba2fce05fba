"""Read blocks of G-code: the main loop over lines."""

import math

from amprep.arrays import Bytes, Floats
from amprep.kernels.gcode.lines import hash_of, matches, place_of
from amprep.kernels.gcode.records import (
    FEATURE,
    FULL,
    HALF_WIDTH,
    MORE,
    MOST_CHORDS,
    OBJECT,
    RELATIVE,
    RELATIVE_E,
    ROLE,
    SEGMENTS,
    SLOT,
    UNIT,
    UNKNOWN_LINE,
    E,
    I,
    J,
    KnownLines,
    Machine,
    R,
    Tracks,
    X,
    Y,
    Z,
)
from amprep.kernels.gcode.text import BLANK, RETURN, TAB, line_end, number, skip_blanks
from amprep.kernels.gcode.tracks import extrude, extrude_arc
from amprep.kernels.helper import helper, kernel

_WIDEST_LINE = 10.0
"""Widths of lines (mm) beyond it are ignored."""


@kernel
def parse(
    text: Bytes,
    start: int,
    end: int,
    machine: Machine,
    tracks: Tracks,
    known: KnownLines,
    segments: Floats,
) -> tuple[int, int]:
    """Read the complete lines of a block.

    G90 and G91 leave the mode of E alone, because slicers state that with M82 and M83.

    Parameters
    ----------
    text, start, end
        The block, and the range of it to read.
    machine, tracks
        The state so far; modified.
    known
        What labels and features mean.
    segments
        ``(n, COLUMNS)`` the lines of recorded layers; those before ``machine.modes[SEGMENTS]`` are kept.

    Returns
    -------
    The index of the first line that was not read, and why: `MORE`, `FULL` or `UNKNOWN_LINE`.
    """
    modes = machine.modes
    i = start
    while True:
        if modes[SEGMENTS] + MOST_CHORDS > len(segments):
            return i, FULL
        j = line_end(text, i, end)
        if j < 0:
            return i, MORE
        k = skip_blanks(text, i, j)
        if k < j and (text[k] == ord("N") or text[k] == ord("n")):
            _, k = number(text, k + 1, j)
            k = skip_blanks(text, k, j)
        if k < j:
            letter = text[k]
            if letter == ord("G") or letter == ord("g"):
                code, k = number(text, k + 1, j)
                _command(text, k, j, code, machine, tracks, segments)
            elif not _other_line(text, k, j, machine, known):
                return i, UNKNOWN_LINE
        i = j + 1


@helper
def _other_line(text: Bytes, k: int, j: int, machine: Machine, known: KnownLines) -> bool:
    """Read a line that begins with no G; return False if it concerns the table of known lines, which lacks it."""
    if text[k] == ord("M") or text[k] == ord("m"):
        code, _ = number(text, k + 1, j)
        if code in (82.0, 83.0):
            machine.modes[RELATIVE_E] = int(code) - 82
            return True
    if matches(text, k, j, known.prefix) >= 0:
        key = hash_of(text, k, j)
        place = place_of(known, key)
        if known.key[place] != key:
            return False
        if known.kind[place] == OBJECT:
            machine.modes[SLOT] = known.value[place]
        elif known.kind[place] == FEATURE:
            machine.modes[ROLE] = known.value[place]
        return True
    after = matches(text, k, j, known.width_prefix)
    if after >= 0:
        width, _ = number(text, skip_blanks(text, after, j), j)
        if 0.0 < width <= _WIDEST_LINE:
            machine.at[HALF_WIDTH] = width / 2.0
    return True


@helper
def _command(
    text: Bytes, k: int, j: int, code: float, machine: Machine, tracks: Tracks, segments: Floats
) -> None:
    """Do a G command whose words begin at k."""
    at, modes = machine.at, machine.modes
    if code in (0.0, 1.0, 2.0, 3.0):
        _move(_words(text, k, j, machine, False), int(code), machine, tracks, segments)
    elif code in (90.0, 91.0):
        modes[RELATIVE] = int(code) - 90
    elif code in (20.0, 21.0):
        at[UNIT] = 25.4 if code == 20.0 else 1.0
    elif code == 28.0:
        given = _words(text, k, j, machine, True) & 7
        for axis in range(3):
            if given == 0 or given >> axis & 1:
                at[axis], at[axis + 4] = 0.0, 0.0
    elif code == 92.0:
        given = _words(text, k, j, machine, False)
        for axis in range(3):
            if given >> axis & 1:
                at[axis + 4] = at[axis] - machine.words[axis] * at[UNIT]
        if given >> E & 1:
            at[E] = machine.words[E] * at[UNIT]


@helper
def _words(text: Bytes, k: int, j: int, machine: Machine, letters: bool) -> int:
    """Read the words of a line into `machine.words`; return a bit for each.

    A letter without a number is a word only if `letters` is true.
    """
    given = 0
    while k < j:
        c = text[k]
        k += 1
        if c in (BLANK, TAB, RETURN):
            continue
        if c == ord(";") or c == ord("(") or c == ord("*"):
            break
        word = _word_of(c & 0xDF)
        begin = skip_blanks(text, k, j)
        value, k = number(text, begin, j)
        if word >= 0 and (letters or k > begin):
            machine.words[word] = value
            given |= 1 << word
    return given


@helper
def _word_of(letter: int) -> int:
    """Return the index of a word by its capital letter, -1 for words without meaning here."""
    if ord("X") <= letter <= ord("Z"):
        return letter - ord("X")
    if letter == ord("E"):
        return E
    if letter == ord("I") or letter == ord("J"):
        return I + letter - ord("I")
    return R if letter == ord("R") else -1


@helper
def _move(given: int, code: int, machine: Machine, tracks: Tracks, segments: Floats) -> None:
    """Move to the position of the words, straight (code 0 or 1) or on an arc (2 clockwise, 3 counter-clockwise)."""
    at, words, modes = machine.at, machine.words, machine.modes
    unit = at[UNIT]
    x, y, z = at[X], at[Y], at[Z]
    if given >> X & 1:
        x = words[X] * unit + (at[X] if modes[RELATIVE] else at[X + 4])
    if given >> Y & 1:
        y = words[Y] * unit + (at[Y] if modes[RELATIVE] else at[Y + 4])
    if given >> Z & 1:
        z = words[Z] * unit + (at[Z] if modes[RELATIVE] else at[Z + 4])
    fed = 0.0
    if given >> E & 1:
        value = words[E] * unit
        fed = value if modes[RELATIVE_E] else value - at[E]
        at[E] += fed
    at[Z] = z
    if fed > 0.0:
        if code >= 2:
            centre_x, centre_y, is_arc = _centre(given, code, machine, x, y)
            if is_arc:
                extrude_arc(machine, tracks, segments, centre_x, centre_y, x, y, code == 2)
            else:
                extrude(machine, tracks, segments, x, y)
        elif x != at[X] or y != at[Y]:
            extrude(machine, tracks, segments, x, y)
    at[X], at[Y] = x, y


@helper
def _centre(given: int, code: int, machine: Machine, x: float, y: float) -> tuple[float, float, bool]:
    """Return the centre of an arc to (x, y), and whether there is one."""
    at, words = machine.at, machine.words
    if given >> R & 1:
        radius = words[R] * at[UNIT]
        dx, dy = x - at[X], y - at[Y]
        chord = math.hypot(dx, dy)
        if chord == 0.0 or radius == 0.0:
            return 0.0, 0.0, False
        height = math.sqrt(max(radius * radius - chord * chord / 4.0, 0.0)) / chord
        if (code == 3) == (radius < 0.0):
            height = -height
        return at[X] + dx / 2.0 - height * dy, at[Y] + dy / 2.0 + height * dx, True
    along = words[I] * at[UNIT] if given >> I & 1 else 0.0
    across = words[J] * at[UNIT] if given >> J & 1 else 0.0
    return at[X] + along, at[Y] + across, along != 0.0 or across != 0.0
