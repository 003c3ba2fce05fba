"""Files without a command are run; the recipes for desktops on the page about slicers call commands that exist."""

import configparser
import json
import re
import shlex
from pathlib import Path

import pytest
import typer
from tests.shared.builds import box_mesh
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.stl import write_stl

PAGE = Path(__file__).parents[3] / "docs" / "slicers.md"


def recipe(language):
    """The only block of code in a language on the page."""
    blocks = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 1
    return blocks[0]


def test_the_desktop_entry_has_the_keys_that_its_specification_requires():
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str  # type: ignore[method-assign, assignment]
    parser.read_string(recipe("ini"))
    entry = parser["Desktop Entry"]
    assert entry["Type"] == "Application"
    assert entry["Name"]
    assert "%F" in entry["Exec"]
    assert entry["MimeType"].endswith(";")


@pytest.mark.parametrize("language", ["ini", "bat", "sh"])
def test_each_recipe_calls_amprep_with_options_that_exist(language):
    line = re.search(r"amprep (run .*)$", recipe(language), re.MULTILINE)
    assert line is not None
    words = [word for word in shlex.split(line[1]) if not word.startswith(("%", "$"))]
    command = typer.main.get_command(app).commands[words[0]]  # type: ignore[attr-defined]
    context = command.make_context("run", [*words[1:], "part.stl"])
    assert context.params["inputs"] == ["part.stl"]
    assert context.params["open_report"] is True


def test_files_without_a_command_are_run(tmp_path):
    box = str(tmp_path / "box.stl")
    write_stl(box_mesh((0, 0, 0), (5, 5, 5)), tmp_path / "box.stl")
    ended = CliRunner().invoke(app, [box, "--set", "supports.enabled=false", "--dry-run", "--json", "-q"])
    assert ended.exit_code == 0
    assert json.loads(ended.stdout)["job"] == "box"
    assert ended.stderr == ""


@pytest.mark.parametrize("name", ["bx.stl", "x" * 5000, "a\0b"])
def test_what_is_neither_a_command_nor_a_file_is_an_error(name):
    ended = CliRunner().invoke(app, [name])
    assert ended.exit_code == 2
    assert "No such command" in ended.output
