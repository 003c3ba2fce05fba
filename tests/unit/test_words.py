"""Home-made words that the standard terms of the glossary replace occur neither in code nor in pages."""

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SUFFIXES = {".py", ".md", ".toml", ".template", ".js"}
FILES = sorted(
    path
    for path in (
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*"),
        *(ROOT / "src").rglob("*"),
        *(ROOT / "plugins").rglob("*"),
        ROOT / "fixtures" / "README.md",
    )
    if path.suffix in SUFFIXES and path.name != "viewer.bundle.js"
)

REPLACED = {
    "settled?": "validate and repair",
    "needy|bare|needs_of|has_way": "overhanging, unsupported, reachable",
    "wish|wishes|Wishes": "rules, part settings",
    "reds": "red squares",
    "footings?|endings": "base, part interface",
    "trunks": "trunk edges; expanded cells",
    "sort_out|sorted out|emitted_cells": "classify",
    "find_ways|ways? out|clip_into|stand_on": "columns, drain holes, prisms_below",
    "lids?": "top",
    "carv(?:e|ed|es|ing)": "subtract, offset, clip",
    "thinning|insets?|refining|handles_of": "decimation, offset, subdivision, genus",
    "crowded": "non-manifold",
    "redo|erase|take back": "rip up and reroute",
    "sortings": "orderings",
    "homes": "feasible positions",
    "stock": "demand",
    r"worth(?! a check)": "value",
    "standing": "obstacles",
    "heat|most_ruined": "temperature, ruin size",
    "set partitioning": "set covering",
    "white cubes?|black cubes?": "free voxel, occupied voxel",
    "cover_bound|Manner": "fractional covering bound, search settings",
    "shares? of|share_of": "fraction, ratio",
    "want of room": "no free voxel below",
    "holds for|hold for": "applies to, is valid for",
    "all the same": "nevertheless",
    "next door": "neighbouring",
    "such ones|in the way": "blocking",
}
"""Pattern of home-made words -> the standard term."""

ALLOWED = {
    ("docs/glossary.md", "white cube"): "the thesis's word",
    ("docs/glossary.md", "black cube"): "the thesis's word",
    ("docs/map.md", "black cubes"): "the thesis's word",
    ("src/amprep/checks/supports/bodies.py", "standing"): "the promise that supports stand on the plate",
    ("src/amprep/checks/supports/bodies.py", "STANDING"): "the promise that supports stand on the plate",
    ("src/amprep/pipeline/verifying/build.py", "STANDING"): "the promise that supports stand on the plate",
    ("src/amprep/pipeline/verifying/extents.py", "STANDING"): "the promise that supports stand on the plate",
    (
        "src/amprep/plugins/cells/hatch/__init__.py",
        "THINNING",
    ): "a thinner wall, not a mesh of fewer triangles",
    ("src/amprep/plugins/cells/x_wall/__init__.py", "THINNING"): "a thinner wall",
    ("src/amprep/plugins/cells/x_wall/__init__.py", "thinning"): "a thinner wall",
    (
        "src/amprep/plugins/cells/x_wall/__init__.py",
        "inset",
    ): "a distance of two walls, not an offset of a mesh",
    ("src/amprep/plugins/cells/x_wall/__init__.py", "insets"): "a distance of two walls",
    ("src/amprep/plugins/cells/x_wall/shapes.py", "thinning"): "a thinner wall",
    ("src/amprep/plugins/cells/x_wall/shapes.py", "inset"): "a distance of two walls",
    ("src/amprep/plugins/cells/x_wall/shapes.py", "Insets"): "a distance of two walls",
    ("src/amprep/plugins/cells/x_wall/shapes.py", "insets"): "a distance of two walls",
}
"""(file, word) -> why the word is the standard term there."""


@cache
def text_of(path):
    return path.read_text(encoding="utf-8")


def occurrences(pattern):
    """The places (file, word) of a pattern as whole words."""
    words = re.compile(rf"(?<![A-Za-z])(?:{pattern})(?![A-Za-z_])", re.IGNORECASE)
    for path in FILES:
        for found in words.finditer(text_of(path)):
            yield path.relative_to(ROOT).as_posix(), found.group()


@pytest.mark.parametrize(("pattern", "term"), REPLACED.items())
def test_a_replaced_word_does_not_come_back(pattern, term):
    assert sorted({place for place in occurrences(pattern) if place not in ALLOWED}) == [], f"say: {term}"


def test_every_exception_is_in_use():
    used = {place for pattern in REPLACED for place in occurrences(pattern)}
    assert set(ALLOWED) - used == set()
