"""The page about job files, which is the only place where the meaning of keys is written."""

import re
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

_ROW = re.compile(r"^\| `(\w+)` \| (.*?) \| (.*) \|$", re.MULTILINE)
_SECTIONS = {"Top level": "", "`[packing]`": "packing", "`[supports]`": "supports", "`[cells]`": "cells"}
_SECTIONS |= {"`[reading]`": "reading", "`[[part]]`": "part", "`[[rule]]`": "rule"}
_LINK = re.compile(r"\s*\((?:see )?\[[^\]]*\]\([^)]*\)\)|; see \[[^\]]*\]\([^)]*\)")
_INNER_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class KeyText(NamedTuple):
    """Default and meaning of a key, in words."""

    default: str
    meaning: str


@cache
def key_texts() -> dict[str, dict[str, KeyText]]:
    """Return the texts of all keys by section, ``""`` for the keys at the top."""
    found: dict[str, dict[str, KeyText]] = {}
    for block in _page().split("\n## ")[1:]:
        heading, _, body = block.partition("\n")
        if heading in _SECTIONS:
            rows = _ROW.findall(body)
            found[_SECTIONS[heading]] = {
                key: KeyText(_plain(default), _plain(meaning)) for key, default, meaning in rows
            }
    return found


def _page() -> str:
    """Return the page: an installed package contains a copy, a source tree has it among its documents."""
    packed = files("amprep").joinpath("job", "reference", "job-file.md")
    if packed.is_file():
        return packed.read_text(encoding="utf-8")
    return (Path(__file__).parents[4] / "docs" / "job-file.md").read_text(encoding="utf-8")


def _plain(text: str) -> str:
    """Return a text without links and marks of code."""
    return _INNER_LINK.sub(r"\1", _LINK.sub("", text)).replace("`", "").strip()
