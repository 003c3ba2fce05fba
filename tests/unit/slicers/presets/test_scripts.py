"""The command is added to the scripts of a profile, once, and everything else stays as it is."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.errors import InputError
from amprep.slicers.presets.scripts import SCRIPTS, with_script_ini, with_script_json

COMMAND = '"/a b/amprep" hook gcode --strict'
IN_INI = r'post_process = "\"/a b/amprep\" hook gcode --strict"'


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("layer_height = 0.2\n", f"layer_height = 0.2\n{IN_INI}\ngcode_label_objects = 1\n"),
        (
            "gcode_label_objects = 0\npost_process = \nz = 1\n",
            f"gcode_label_objects = 1\n{IN_INI}\nz = 1\n",
        ),
        (
            "gcode_label_objects = firmware\r\npost_process = \r\n",
            f"gcode_label_objects = firmware\r\n{IN_INI}\r\n",
        ),
        (
            'gcode_label_objects = 1\npost_process = "/x/a.py --b";/y/c.sh\n',
            'gcode_label_objects = 1\npost_process = "/x/a.py --b";"/y/c.sh";'
            + IN_INI.removeprefix("post_process = ")
            + "\n",
        ),
        (
            'gcode_label_objects = 1\npost_process = "/old/amprep hook gcode"\n',
            f"gcode_label_objects = 1\n{IN_INI}\n",
        ),
    ],
)
def test_the_command_is_added_to_a_profile_of_prusaslicer(before, after):
    assert with_script_ini(before, COMMAND) == after
    assert with_script_ini(after, COMMAND) == after


@given(st.lists(st.text("ab \\\";n'", min_size=1).filter(str.strip), max_size=3))
def test_scripts_survive_any_quotes(scripts):
    text = "gcode_label_objects = 1\n"
    for each in scripts:
        text = with_script_ini(text.replace(" hook gcode", " other"), f"{each} hook gcode")
    again = with_script_ini(text, COMMAND)
    assert again.count("\n") == 2
    for each in scripts[:-1]:
        written = each.replace("\\", "\\\\").replace('"', '\\"')
        assert f'"{written} other"' in again


def test_the_command_is_added_to_a_profile_of_orcaslicer():
    before = {"name": "fine", "inherits": "0.20mm Standard", SCRIPTS: ["/x/a.py", "/old/amprep hook gcode"]}
    text = with_script_json(json.dumps(before), COMMAND)
    after = json.loads(text)
    assert after == {**before, SCRIPTS: ["/x/a.py", COMMAND], "gcode_label_objects": "1"}
    assert with_script_json(text, COMMAND) == text


@pytest.mark.parametrize("text", ["", "[]", "{"])
def test_what_is_no_profile_of_orcaslicer_is_refused(text):
    with pytest.raises(InputError, match="JSON"):
        with_script_json(text, COMMAND)
