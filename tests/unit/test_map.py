"""The map from the thesis to the code: every section is on it, and every path on it exists."""

import re
from pathlib import Path

import pytest
from tests.unit.test_rooms import SECTIONS

ROOT = Path(__file__).parents[2]
ROWS = re.findall(
    r"^\| (\d(?:\.\d)?) \| ([^|]+) \| ([^|]+) \|$",
    (ROOT / "docs" / "map.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)


def test_every_section_of_the_thesis_is_on_the_map():
    assert {section for section, _, _ in ROWS} == set(SECTIONS)


@pytest.mark.parametrize(("section", "idea", "places"), ROWS)
def test_every_path_on_the_map_exists(section, idea, places):
    paths = [word for word in re.findall(r"`([^`]+)`", places) if "/" in word]
    assert paths or places == "not implemented yet", f"{section} {idea} names no place"
    assert [path for path in paths if not (ROOT / "src" / "amprep" / path).exists()] == []
