"""A way to call the command line as a shell would, and the fixtures' folder."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

FIXTURES = Path(__file__).parents[2] / "fixtures"


@dataclass(frozen=True)
class Outcome:
    """What a call printed and how it ended."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@pytest.fixture
def amprep(monkeypatch, capsys) -> Callable[..., Outcome]:
    """Return a function that runs `amprep` with the given arguments."""

    def call(*arguments: str | Path) -> Outcome:
        from amprep.cli import main

        monkeypatch.setattr("sys.argv", ["amprep", *map(str, arguments)])
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main()
        printed = capsys.readouterr()
        return Outcome(int(end.value.code or 0), printed.out, printed.err)

    return call


@pytest.fixture(scope="session")
def fixtures() -> Path:
    """Return the folder of the shipped fixtures."""
    return FIXTURES
