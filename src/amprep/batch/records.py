"""Records of a batch: what is to run, and how it ended."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

State = Literal["done", "incomplete", "refused", "crashed", "not run"]
"""``incomplete``: something is unplaced, unsupported or fails verification; ``refused``: the input is wrong."""

STATES: Mapping[State, str] = {
    "done": "done",
    "incomplete": "incomplete: something is unplaced, unsupported or fails verification",
    "refused": "refused: wrong input",
    "crashed": "crashed: its process ended",
    "not run": "not run",
}


@dataclass(frozen=True)
class BatchJob:
    """A job of a batch.

    Attributes
    ----------
    name
        Name that is different for each job of the batch.
    source
        The job file, or the file whose parts are to be printed.
    folder
        Output folder of the job alone.
    arguments
        Options of ``amprep run`` that the whole batch has.
    digest
        SHA-256 of all that determines the result, as `with_digest` finds it; empty if the job cannot be read.
    """

    name: str
    source: Path
    folder: Path
    arguments: tuple[str, ...] = ()
    digest: str = ""


class JobFigures(NamedTuple):
    """What the report of a job says in numbers."""

    builds: int = 0
    parts: int = 0
    unplaced: int = 0
    must_fix: int = 0
    worth_a_check: int = 0


_NONE = JobFigures()


@dataclass(frozen=True)
class JobOutcome:
    """How a job ended.

    Attributes
    ----------
    name, source, folder
        As in `BatchJob`.
    state
        How it ended.
    message
        What went wrong, in one line; empty if nothing did.
    figures
        Numbers of its report.
    files
        Names of the files in its folder.
    seconds
        Time that it took.
    earlier
        Whether it was finished in an earlier batch, and is not run again.
    """

    name: str
    source: Path
    folder: Path
    state: State
    message: str = ""
    figures: JobFigures = _NONE
    files: tuple[str, ...] = ()
    seconds: float = 0.0
    earlier: bool = False

    @property
    def page(self) -> str:
        """Name of the page among its files; empty if there is none."""
        return next((name for name in self.files if name.endswith(".report.html")), "")


@dataclass(frozen=True)
class BatchRecord:
    """All jobs of a batch, in their order.

    Attributes
    ----------
    version
        Version of amprep.
    outcomes
        How the jobs ended.
    seconds
        Time of the batch.
    files
        Files of the batch itself, in its output folder.
    """

    version: str
    outcomes: tuple[JobOutcome, ...]
    seconds: float
    files: tuple[str, ...] = ()

    @property
    def faults(self) -> int:
        """Number of jobs that are not done."""
        return sum(each.state != "done" for each in self.outcomes)

    @property
    def counts(self) -> Mapping[State, int]:
        """Number of jobs in each state that occurs."""
        found = Counter(each.state for each in self.outcomes)
        return {state: found[state] for state in STATES if found[state]}
