"""Choose one colour for each part, the same in the picture and in the 3D view."""

import re
from colorsys import rgb_to_hsv

from amprep.model import Build
from amprep.report.triage.classes import CHECK, MUST_FIX, Triage

PALETTE = (
    "#4c78a8", "#54a24b", "#b279a2", "#72b7b2", "#9d755d", "#6b8ead", "#88d27a", "#8c6bb1",
    "#83bcb6", "#7f9c3b", "#5f6b7a", "#a3b5d6", "#3f7f6f", "#c3a6d8", "#8a8d5b", "#b3907c",
)  # fmt: skip
"""Colours of parts: none is near red or orange, which mark findings."""
SUPPORT = "#c9ced6"
MARK_COLOURS: dict[Triage, str] = {MUST_FIX: "#e5202b", CHECK: "#f28c00"}
"""Class -> colour of its marks; what is in order has none."""
VOLUME = "#d98b2b"
"""Colour of a bounding volume of one piece, and of the outlines of all."""


def part_colours(build: Build) -> list[str]:
    """Return ``#rrggbb`` for each placed part: its own colour if it has one, else one of the palette.

    Copies of a part have the same colour. A colour like that of a mark is replaced by one of the palette. The palette
    is also used if all parts have the same colour, which would not distinguish them.
    """
    names = list(dict.fromkeys(placed.part.name for placed in build.parts))
    given = [_own(placed.part.appearance.colour) for placed in build.parts]
    if len(names) > 1 and len(set(given)) == 1:
        given = [None] * len(given)
    owned = [rgb(own) for own in given if own]
    free = [
        colour for colour in PALETTE if not any(_are_close(rgb(colour), each) for each in owned)
    ] or PALETTE
    return [
        own or free[names.index(placed.part.name) % len(free)]
        for own, placed in zip(given, build.parts, strict=True)
    ]


def rgb(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue of ``#rrggbb``, each in [0, 1]."""
    value = int(colour[1:7], 16)
    return (value >> 16) / 255, (value >> 8 & 255) / 255, (value & 255) / 255


def is_like_a_mark(colour: str) -> bool:
    """Tell whether ``#rrggbb`` is a strong red or orange, on which marks would not be seen."""
    hue, saturation, value = rgb_to_hsv(*rgb(colour))
    return (hue > 0.93 or hue < 0.12) and saturation > 0.6 and value > 0.6


def _are_close(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    return max(abs(a - b) for a, b in zip(one, other, strict=True)) < 0.2


def _own(colour: str | None) -> str | None:
    """Return ``#RRGGBB[AA]`` as ``#rrggbb``; None for anything else, and for colours like those of marks."""
    if not colour or not re.fullmatch(r"#[0-9a-fA-F]{6}([0-9a-fA-F]{2})?", colour):
        return None
    own = colour[:7].lower()
    return None if is_like_a_mark(own) else own
