"""A font of straight strokes, of our own making: capitals, digits and a few signs on a grid of 4 by 6 units."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats

HEIGHT, WIDTH, ADVANCE = 6.0, 4.0, 6.0
"""Height and width of a glyph, and distance of two neighbouring glyphs, in units of the grid."""

_GLYPHS = {
    "A": "00 05 16 36 45 40/03 43",
    "B": "00 06 36 45 44 33 03/33 42 41 30 00",
    "C": "45 36 16 05 01 10 30 41",
    "D": "00 06 26 44 42 20 00",
    "E": "46 06 00 40/03 33",
    "F": "46 06 00/03 33",
    "G": "45 36 16 05 01 10 30 41 43 23",
    "H": "00 06/40 46/03 43",
    "I": "20 26/16 36/10 30",
    "J": "46 41 30 10 01",
    "K": "00 06/46 13/03 13 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "10 01 05 16 36 45 41 30 10",
    "P": "00 06 36 45 44 33 03",
    "Q": "10 01 05 16 36 45 41 30 10/22 40",
    "R": "00 06 36 45 44 33 03/23 40",
    "S": "45 36 16 05 04 13 33 42 41 30 10 01",
    "T": "06 46/26 20",
    "U": "06 01 10 30 41 46",
    "V": "06 20 46",
    "W": "06 10 23 30 46",
    "X": "00 46/06 40",
    "Y": "06 23 46/23 20",
    "Z": "06 46 00 40",
    "0": "10 01 05 16 36 45 41 30 10/14 32",
    "1": "04 26 20/00 40",
    "2": "05 16 36 45 44 00 40",
    "3": "05 16 36 45 44 33 13/33 42 41 30 10 01",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 00",
    "6": "45 36 16 05 01 10 30 41 42 33 03",
    "7": "06 46 10",
    "8": "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
    "9": "01 10 30 41 45 36 16 05 04 13 43",
    "-": "03 43",
    "_": "00 40",
    "/": "00 46",
    ".": "20 20",
    ":": "21 21/24 24",
    "+": "03 43/21 25",
    "#": "10 16/30 36/02 42/04 44",
    " ": "",
}
"""Glyph -> its strokes, each a row of points: column 0 to 4, then row 0 to 6 from the base line upwards."""


class Strokes(NamedTuple):
    """The strokes of a text: both ends of each, ``(n, 2, 2)`` in units of the grid, and the width of the text."""

    ends: Floats
    width: float


def unknown_in(text: str) -> str:
    """Return the characters of a text that the font does not have, each once."""
    return "".join(dict.fromkeys(each for each in text if each.upper() not in _GLYPHS))


def strokes_of(text: str) -> Strokes:
    """Return the strokes of a text that the font has; small letters are written as capitals."""
    ends = [
        (first, second)
        for place, each in enumerate(text.upper())
        for stroke in _GLYPHS[each].split("/")
        for first, second in _segments(stroke, place * ADVANCE)
    ]
    width = max(len(text), 1) * ADVANCE - (ADVANCE - WIDTH)
    return Strokes(np.array(ends, np.float64).reshape(-1, 2, 2), width)


def _segments(stroke: str, shift: float) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    points = [(shift + int(each[0]), float(int(each[1]))) for each in stroke.split()]
    return list(zip(points, points[1:], strict=False))
