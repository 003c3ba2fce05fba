"""Options that commands share: declared once, listed by every command, and passed on as one record."""

from dataclasses import dataclass, fields
from typing import Annotated, Any

import pytest
import typer
from typer.testing import CliRunner

from amprep.cli.app import app
from amprep.cli.options import BuildOptions, JobOptions, with_options


@dataclass(frozen=True, kw_only=True)
class Shared:
    count: Annotated[int, typer.Option("--count", help="Number of copies.")] = 1
    names: Annotated[list[str] | None, typer.Option("--name", help="Name.")] = None


def invoke(*arguments):
    """Run a command of its own and return what it got."""
    got: dict[str, Any] = {}
    small = typer.Typer()

    @small.command()
    @with_options(Shared)
    def command(path: str, flag: Annotated[bool, typer.Option("--flag")] = False, *, options: Shared) -> None:
        """Do something."""
        got.update(path=path, flag=flag, options=options)

    result = CliRunner().invoke(small, arguments)
    assert result.exit_code == 0, result.output
    return got, result.output


def test_a_command_gets_the_shared_options_as_one_record():
    got, _ = invoke("a.stl", "--count", "3", "--name", "x", "--name", "y", "--flag")
    assert got == {"path": "a.stl", "flag": True, "options": Shared(count=3, names=["x", "y"])}


def test_an_option_that_is_not_given_has_its_default():
    got, _ = invoke("a.stl")
    assert (got["flag"], got["options"]) == (False, Shared())


def test_help_lists_own_and_shared_options():
    _, output = invoke("--help")
    assert all(text in output for text in ("Do something.", "--flag", "--count", "Number of copies."))


@pytest.mark.parametrize(
    ("command", "options"), [("run", BuildOptions), ("support", BuildOptions), ("lattice", JobOptions)]
)
def test_every_command_that_takes_a_job_has_the_shared_options(command, options):
    group: Any = typer.main.get_command(app)
    declared = group.commands[command].params
    assert {each.name for each in declared} >= {field.name for field in fields(options)}
    assert all(each.help for each in declared if each.param_type_name == "option")


def test_options_change_the_job_only_where_they_are_given():
    changes = BuildOptions(printer="EOS M290", router="tree", target="cura", seed=3).changes
    assert {key: value for key, value in changes.items() if value is not None} == {
        "printer": "EOS M290",
        "supports.strategy": "tree",
        "target": "cura",
        "seed": 3,
    }
