"""Find the jobs of a batch: job files, and 3MF files that no job file names."""

import os
import re
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from amprep.batch.digest import files_of
from amprep.batch.records import BatchJob
from amprep.errors import AmprepError, InputError
from amprep.job import job_of

MOST_JOBS = 100_000
"""Largest number of jobs of a batch."""

_LARGEST_TOML = 16 << 20
"""Larger files in a folder are no job files, bytes."""

_OF_A_RUN = re.compile(r"\.(build-\d+|supported|replanned|lattice)\.3mf$")
"""Ends of the names of files that amprep writes."""


def find_jobs(inputs: Sequence[Path], output: Path, arguments: Sequence[str]) -> list[BatchJob]:
    """Return the jobs of files and folders, in order, each with a name and an output folder of its own.

    In a folder and its subfolders the jobs are the job files, that is TOML files with ``inputs`` or ``[[part]]``, and
    the 3MF files that no job names. Hidden files, and what is in the output folder, are left out.

    Parameters
    ----------
    inputs
        Job files, files with parts, and folders.
    output
        Output folder of the batch.
    arguments
        Options of ``amprep run`` for all jobs.

    Raises
    ------
    InputError
        When an input does not exist, or there are no jobs, or too many.
    """
    sources = [found for each in inputs for found in _sources(each, output.resolve())]
    if not sources:
        raise InputError(
            f"no job to run in {', '.join(map(str, inputs))}; expected job files (.toml) or 3MF files"
        )
    if len(sources) > MOST_JOBS:
        raise InputError(f"more than {MOST_JOBS} jobs; name the folders with the jobs")
    names = _unique([name for _, name in sources])
    return [
        BatchJob(name, source, output / name, tuple(arguments))
        for (source, _), name in zip(sources, names, strict=True)
    ]


def _sources(path: Path, output: Path) -> list[tuple[Path, str]]:
    """Return the jobs of an input with their names: the path relative to the folder, without its suffix."""
    if path.is_file():
        return [(path.resolve(), path.stem)]
    if not path.is_dir():
        raise InputError(f"{path}: no such file or folder")
    files = list(_files(path.resolve(), output))
    jobs = [each for each in files if each.suffix.lower() == ".toml" and _is_job(each)]
    named = {file.resolve() for job in jobs for file in _named(job)}
    alone = [each for each in files if each.suffix.lower() == ".3mf" and each.resolve() not in named]
    root = path.resolve()
    return [(each, each.relative_to(root).with_suffix("").as_posix()) for each in sorted([*jobs, *alone])]


def _files(folder: Path, output: Path) -> Iterator[Path]:
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(
            each for each in folders if not each.startswith(".") and Path(here, each).resolve() != output
        )
        for name in sorted(names):
            if not name.startswith(".") and not _OF_A_RUN.search(name):
                yield Path(here, name)


def _is_job(path: Path) -> bool:
    """Tell whether a file is a job file and no profile; one that cannot be read is, so that its error is shown."""
    with suppress(OSError):
        if path.stat().st_size > _LARGEST_TOML:
            return False
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except ValueError:
            return True
        return "inputs" in table or "part" in table
    return False


def _named(job: Path) -> list[Path]:
    """Return the files that a job names; none if the job is wrong."""
    with suppress(AmprepError):
        return files_of(job_of([str(job)]))
    return []


def _unique(names: Sequence[str]) -> list[str]:
    """Return different names, which also differ on file systems that ignore upper and lower case."""
    taken: set[str] = set()
    unique = []
    for name in names:
        number, own = 1, name
        while own.casefold() in taken:
            number += 1
            own = f"{name}-{number}"
        taken.add(own.casefold())
        unique.append(own)
    return unique
