"""Choose one colour for each part, the same in the picture and in the 3D view."""

import re

from amprep.model import Build

PALETTE = (
    "#4c78a8", "#f58518", "#54a24b", "#b279a2", "#e45756", "#72b7b2", "#eeca3b", "#9d755d",
    "#ff9da6", "#6b8ead", "#d6a56c", "#88d27a", "#8c6bb1", "#83bcb6", "#c9714f", "#7f9c3b",
)  # fmt: skip
SUPPORT = "#c9ced6"
UNSUPPORTED = "#e5202b"
VOLUME = "#d98b2b"
"""Colour of a bounding volume of one piece, and of the outlines of all."""


def part_colours(build: Build) -> list[str]:
    """Return ``#rrggbb`` for each placed part: its own colour if it has one, else one of the palette.

    Copies of a part have the same colour. The palette is also used if all parts have the same colour, which would
    not distinguish them.
    """
    names = list(dict.fromkeys(placed.part.name for placed in build.parts))
    given = [_own(placed.part.appearance.colour) for placed in build.parts]
    if len(names) > 1 and len(set(given)) == 1:
        given = [None] * len(given)
    return [
        own or PALETTE[names.index(placed.part.name) % len(PALETTE)]
        for own, placed in zip(given, build.parts, strict=True)
    ]


def rgb(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue of ``#rrggbb``, each in [0, 1]."""
    value = int(colour[1:7], 16)
    return (value >> 16) / 255, (value >> 8 & 255) / 255, (value & 255) / 255


def _own(colour: str | None) -> str | None:
    """Return ``#RRGGBB[AA]`` as ``#rrggbb``; None for anything else."""
    return (
        colour[:7].lower() if colour and re.fullmatch(r"#[0-9a-fA-F]{6}([0-9a-fA-F]{2})?", colour) else None
    )
