"""Prepare a plate: write the models, make the profile of the printer, run amprep."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

from .bed import Bed
from .model_file import write_models
from .outcome import Outcome, outcome_of
from .plate import Model
from .process import OnProgress, Process
from .settings import Settings, import_arguments, run_arguments

_FOR_PROGRAMS = "plate"
"""Folder beside the build files for what amprep reads."""


@dataclass(frozen=True, eq=False)
class Order:
    """What is to be prepared.

    Attributes
    ----------
    models
        The models on the plate; at least one.
    bed
        The bed of the active machine.
    name
        Name of the job, after which files are named.
    """

    models: Sequence[Model]
    bed: Bed
    settings: Settings
    name: str

    @property
    def folder(self) -> Path:
        """The folder of the files."""
        return Path(self.settings.folder).expanduser() if self.settings.folder else Path.home() / "amprep"


def prepare(order: Order, process: Process, on_progress: OnProgress) -> Outcome:
    """Return the outcome of preparing a plate; every failure is an outcome with its reason.

    Parameters
    ----------
    order
        What is to be prepared.
    process
        Runs the commands; another thread may cancel it.
    on_progress
        Called with the stage, its fraction and a message.
    """
    try:
        on_progress("models", 0.0, "")
        plate = _written_plate(order)
        printer = order.settings.printer or _own_printer(order, process, on_progress)
    except _FailedError as failure:
        return failure.outcome
    except OSError as error:
        return Outcome(f"Cannot write to {order.folder}: {error.strerror or error}.")
    command = run_arguments(order.settings, str(plate), str(order.folder), order.name, printer)
    return outcome_of(process.run(command, on_progress), order.folder)


class _FailedError(Exception):
    """A command failed, with this outcome."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.text)
        self.outcome = outcome


def _written_plate(order: Order) -> Path:
    folder = order.folder / _FOR_PROGRAMS
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{order.name}.3mf"
    with path.open("wb") as stream:
        write_models(order.models, stream)
    return path


def _own_printer(order: Order, process: Process, on_progress: OnProgress) -> str:
    """Return the path of the profile that amprep makes from the definition of the active machine."""
    folder = order.folder / _FOR_PROGRAMS
    definition = folder / "machine.def.json"
    definition.write_text(json.dumps(order.bed.definition(), indent=1), encoding="utf-8")
    ended = process.run(import_arguments(order.settings, str(definition), str(folder)), on_progress)
    if ended.code != 0:
        raise _FailedError(outcome_of(ended, folder))
    return _only_file(ended.output)


def _only_file(output: str) -> str:
    try:
        answer: dict[str, Any] = json.loads(output)
        return str(answer["files"][0])
    except (ValueError, KeyError, IndexError, TypeError):
        raise _FailedError(
            Outcome("amprep made no printer profile that this plugin can read; update both.")
        ) from None


def file_name(name: str) -> str:
    """Return a name of a job that is a name of a file everywhere."""
    kept = "".join(sign if sign.isalnum() or sign in " -_." else "-" for sign in name).strip(" -.")
    return kept[:80] or "plate"
