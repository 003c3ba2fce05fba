"""The text of a new job file: what was asked for, and every other key as a comment with its meaning."""

import json
import textwrap
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from amprep.job.reference.page import KeyText, key_texts
from amprep.job.reference.schema import SECTIONS

_WIDTH = 110
_INTRODUCTION = """\
# A job of amprep: what to print, where, and how. Run it by:  amprep run {name}
# Lines that begin with # are the defaults; remove the # to change one. Paths are relative to this file.
"""
_PART = """
# [[part]]                     # settings of one part, or of all parts of a file; repeat it for others
# file = "bracket.stl"
# quantity = 4
# rotations = "z90"            # quarter turns about z
# supports = false

# [[rule]]                     # settings of some overhangs; the first entry that fits wins
# kind = "bore"
# support = false
"""


def template(name: str, inputs: Sequence[str], stated: Mapping[str, Any]) -> str:
    """Return the text of a job file.

    Parameters
    ----------
    name
        Name of the file, for the introduction.
    inputs
        Its inputs.
    stated
        Settings by dotted keys; None leaves a setting at its default.
    """
    texts = key_texts()
    given = {key: value for key, value in stated.items() if value is not None}
    lines = [_INTRODUCTION.format(name=name), f"inputs = {_value(list(inputs))}", ""]
    for key in ("printer", "material", "target", "seed"):
        lines += _key(key, given.get(key), texts[""][key])
    for section, cls in SECTIONS.items():
        lines += ["", f"[{section}]"]
        for field in fields(cls):
            lines += _key(field.name, given.get(f"{section}.{field.name}"), texts[section][field.name])
    return "\n".join(lines) + "\n" + _PART


def _key(name: str, value: Any, text: KeyText) -> list[str]:
    """Return the lines of a key: its meaning as a comment, then the key with its value, or as a comment."""
    words = text.meaning[:1].upper() + text.meaning[1:]
    about = textwrap.wrap(words, _WIDTH, initial_indent="# ", subsequent_indent="#   ")
    if value is not None:
        return [*about, f"{name} = {_value(value)}", ""]
    own = f"{name} = {text.default}"
    return [*about, f"# {own}" if _is_toml(own) else f"# {name} =   # default: {text.default}", ""]


def _is_toml(text: str) -> bool:
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return False
    return True


def _value(value: Any) -> str:
    """Return a value as TOML."""
    return json.dumps(value, ensure_ascii=False)
