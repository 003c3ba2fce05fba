"""Write the script that a slicer runs after slicing into the text of a print profile."""

import json
import re
from typing import Any

from amprep.errors import InputError

SCRIPTS, LABELS = "post_process", "gcode_label_objects"
"""Names of the settings: scripts to run, and whether the objects are labelled."""

_OFF = {"", "0", "disabled"}
_OURS = " hook gcode"
_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"|([^;]+)')


def ini_lines(scripts: list[str]) -> list[str]:
    """Return the two settings as lines of a profile of PrusaSlicer or SuperSlicer."""
    quoted = (each.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") for each in scripts)
    return [f"{SCRIPTS} = " + ";".join(f'"{each}"' for each in quoted), f"{LABELS} = 1"]


def json_lines(scripts: list[str]) -> list[str]:
    """Return the two settings as lines of a profile of OrcaSlicer."""
    return [f'"{SCRIPTS}": {json.dumps(scripts)},', f'"{LABELS}": "1"']


def with_script_ini(text: str, command: str) -> str:
    """Return a profile of PrusaSlicer or SuperSlicer that runs a command, after the scripts that it has.

    An earlier command of amprep is replaced, and the labels of objects are turned on.
    """
    values = dict(re.findall(r"^(\w+) *= *(.*?)\r?$", text, re.MULTILINE))
    scripts = _unquoted(values.get(SCRIPTS, ""))
    line, labels = ini_lines([*_others(scripts), command])
    text = _replaced(text, SCRIPTS, line)
    return _replaced(text, LABELS, labels) if values.get(LABELS, "").strip() in _OFF else text


def with_script_json(text: str, command: str) -> str:
    """Return a profile of OrcaSlicer that runs a command; see `with_script_ini`.

    Raises
    ------
    InputError
        If the text is no JSON object.
    """
    try:
        values: Any = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"not a profile: not JSON ({error})") from error
    if not isinstance(values, dict):
        raise InputError("not a profile: not a JSON object")
    scripts = values.get(SCRIPTS, [])
    known = [str(each) for each in scripts] if isinstance(scripts, list) else [str(scripts)]
    values[SCRIPTS] = [*_others([each for each in known if each]), command]
    values[LABELS] = "1"
    return json.dumps(values, indent=4, ensure_ascii=False) + "\n"


def _others(scripts: list[str]) -> list[str]:
    """Return scripts without those of amprep; one string may hold several lines."""
    lines = [line for each in scripts for line in each.splitlines()]
    return [line for line in lines if line.strip() and _OURS not in line]


def _unquoted(value: str) -> list[str]:
    """Return the strings of a setting that has several, separated by semicolons."""
    found = []
    for quoted, plain in _QUOTED.findall(value):
        text = re.sub(r"\\(.)", lambda match: {"n": "\n", "r": "\r"}.get(match[1], match[1]), quoted)
        found.append(text or plain)
    return [each for each in found if each.strip()]


def _replaced(text: str, name: str, line: str) -> str:
    """Return a text with a line in place of that of a setting, or at its end."""
    pattern = re.compile(rf"^{name} *=.*?(?=\r?$)", re.MULTILINE)
    if pattern.search(text):
        return pattern.sub(lambda _: line, text, count=1)
    ending = "" if not text or text.endswith("\n") else "\n"
    return f"{text}{ending}{line}\n"
