"""The help of every command: one sentence first, and lines that fit a terminal of 80 columns."""

import inspect

import pytest
import typer
from rich.text import Text
from typer.testing import CliRunner

from amprep.cli.app import app

MOST_COLUMNS = 78
"""typer indents help by one column on both sides."""


def commands(command, name="amprep"):
    """Yield the name and the command of the application and of everything below it."""
    yield name, command
    for sub, below in getattr(command, "commands", {}).items():
        yield from commands(below, f"{name} {sub}")


COMMANDS = list(commands(typer.main.get_command(app)))
NAMES = [name for name, _ in COMMANDS]


@pytest.mark.parametrize("command", [command for _, command in COMMANDS], ids=NAMES)
def test_help_begins_with_one_sentence_and_fits_80_columns(command):
    first, *others = inspect.cleandoc(command.help).split("\n\n")
    assert first.endswith(".")
    # typer wraps the first paragraph only
    assert [line for text in others for line in text.splitlines() if len(line) > MOST_COLUMNS] == []


@pytest.mark.parametrize("command", [command for _, command in COMMANDS], ids=NAMES)
def test_every_option_and_argument_says_its_meaning_in_a_sentence(command):
    helps = {each.name: each.help for each in command.params if each.name not in {"help"}}
    assert [name for name, text in helps.items() if not text or text[-1] not in ".'"] == []


def test_an_option_of_several_commands_has_the_same_help():
    helps: dict[str, dict[str, list[str]]] = {}
    for name, command in COMMANDS:
        if name.split()[1:2] != ["bench"]:
            for each in command.params:
                for option in each.opts if each.param_type_name == "option" else ():
                    helps.setdefault(option, {}).setdefault(each.help, []).append(name)
    assert {
        option: found for option, found in helps.items() if len(found) > 1 and option not in DIFFERENT
    } == {}


DIFFERENT = {
    "--output": "a folder, a folder or file, or the folder of a package",
    "-o": "as --output",
    "--dry-run": "a run is planned, an import listed",
    "--effort": "of a packer, or of the search for orientations",
    "--json": "the report of a run, or another result",
    "--job": "what a build is verified against, or by what it is planned again",
    "--report": "as --job",
    "--name": "of a job, or of a profile",
    "--workers": "processes of a run, or jobs of a batch",
    "--quiet": "`verify` has no progress to hide",
    "-q": "as --quiet",
    "--set": "a key of the job, or a parameter of a cell",
    "--strict": "about 3MF files, or about G-code",
    "--time-limit": "of packing and routing, of routing alone, or of volume makers",
    "--volumes": "the volume maker of a run, or the makers to compare",
}
"""Option -> why its help differs."""


@pytest.mark.parametrize("command", [command for _, command in COMMANDS], ids=NAMES)
def test_no_word_of_help_is_lost_as_markup(command):
    texts = [command.help, *(each.help for each in command.params if each.help)]
    assert [text for text in texts if Text.from_markup(text).plain != text] == []


@pytest.mark.parametrize("command", [[], ["run"], ["plugins", "list"]])
def test_help_shows_no_type_beside_options_without_a_value(command):
    shown = CliRunner().invoke(app, [*command, "--help"]).output
    assert "--help" in shown
    assert "<bool>" not in shown
