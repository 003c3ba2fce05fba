"""The job that a command line states; messages about a value name its option instead of the key of job files."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from amprep.job import Job

OPTIONS = {
    "target": "--for",
    "printer": "--printer",
    "material": "--material",
    "labels": "--labels",
    "seed": "--seed",
    "name": "--name",
    "reading.strict": "--strict",
    "reading.unit": "--unit",
    "packing.strategy": "--packer",
    "packing.volumes": "--volumes",
    "packing.effort": "--effort",
    "supports.strategy": "--router",
    "supports.grounding": "--grounding",
    "supports.write_as": "--supports-as",
    "cells.strategy": "--cell",
    "cells.lattice": "--lattice",
    "cells.connector": "--connector",
    "cells.base": "--base",
}
"""Key of job files -> option that sets it."""


def stated_job(inputs: Sequence[str], changes: Mapping[str, Any], sets: Sequence[str] | None) -> "Job":
    """Return the job of the inputs with the settings of options and of ``--set``.

    Parameters
    ----------
    inputs
        Inputs as given on the command line.
    changes
        Settings by dotted keys that options change; None leaves a setting as it is.
    sets
        Values of ``--set``.

    Raises
    ------
    JobError
        For a job file that is wrong, and for an option or a ``--set`` with a wrong value.
    """
    from amprep.job import apply_sets, job_of, override

    job = job_of(inputs)
    with options_named(changes, job.source):
        job = override(job, changes)
    return apply_sets(job, sets or [])


@contextmanager
def options_named(changes: Mapping[str, Any], source: str) -> Iterator[None]:
    """Let a `JobError` about a changed setting name its option: ``--for: expected ...``.

    Parameters
    ----------
    changes
        Settings by dotted keys; None is no change.
    source
        Name of the job in messages.
    """
    from amprep.errors import JobError

    try:
        yield
    except JobError as error:
        message = str(error)
        for key, value in changes.items():
            section, _, name = key.rpartition(".")
            place = f"{source}: [{section}]: {name}" if section else f"{source}: {name}"
            if value is not None and message.startswith((f"{place}:", f"{place} ")):
                raise JobError(f"{OPTIONS[key]}{message.removeprefix(place)}") from error
        raise
