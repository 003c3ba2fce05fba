"""The glossary: one table in alphabetical order, one meaning each, and no word that it has replaced."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| ([^|]+?) \| ([^|]+?) \| ([^|]*?) ?\|$", re.MULTILINE)
ROWS = ROW.findall((ROOT / "docs" / "glossary.md").read_text(encoding="utf-8"))[1:]


def test_the_glossary_is_in_alphabetical_order_and_defines_each_word_once():
    words = [word.lower() for word, _, _ in ROWS]
    assert len(words) > 80
    assert words == sorted(set(words))


@pytest.mark.parametrize(("word", "definition"), [row[:2] for row in ROWS])
def test_a_definition_is_a_sentence_with_a_full_stop(word, definition):
    assert definition[0].isupper() or definition[0] == "`"
    assert definition.endswith(".")
