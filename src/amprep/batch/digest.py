"""What determines the result of a job, as one SHA-256."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path

from amprep import __version__
from amprep.batch.records import BatchJob
from amprep.errors import AmprepError
from amprep.job import Job, job_of
from amprep.job.user_settings import with_user_settings
from amprep.sealing.seal import file_digest

MOST_FILES = 10_000
"""Largest number of files of a job."""


def with_digest(job: BatchJob) -> BatchJob:
    """Return a job with its digest, which is that of its files now."""
    return replace(job, digest=digest_of(job.source, job.arguments))


def digest_of(source: Path, arguments: Sequence[str]) -> str:
    """Return the SHA-256 of the files and settings of a job, of the options, and of the versions of amprep and plugins.

    Parameters
    ----------
    source
        The job file, or the file whose parts are to be printed.
    arguments
        Options of ``amprep run``.

    Returns
    -------
    digest
        Empty if the job, or one of its files, cannot be read.
    """
    try:
        job = with_user_settings(job_of([str(source)])).job
        parts = [__version__, *_plugins(), *arguments, repr(job.printer), repr(job.material), job.name]
        parts += [f"{path} {file_digest(path)}" for path in (source, *files_of(job), *_named(arguments))]
    except AmprepError:
        return ""
    return hashlib.sha256("\n".join(parts).encode("utf-8", "backslashreplace")).hexdigest()


def files_of(job: Job) -> list[Path]:
    """Return the files that a job names, and the files in the folders that it names, in order.

    Raises
    ------
    AmprepError
        When there are too many.
    """
    found = [path for spec in job.inputs for path in _files(spec.path)]
    if len(found) > MOST_FILES:
        raise AmprepError(f"{job.source}: more than {MOST_FILES} files; name the folders with the parts")
    cells = [job.cells.strategy, *(rule.cell for rule in job.rules if rule.cell)]
    found += [path for path in map(Path, cells) if path.is_absolute()]
    return found if job.labels is None else [*found, job.labels]


def _files(path: Path) -> Iterator[Path]:
    if not path.is_dir():
        yield path
        return
    for number, each in enumerate(sorted(path.rglob("*"))):
        if number > MOST_FILES:
            raise AmprepError(f"{path}: more than {MOST_FILES} files; name the folders with the parts")
        if each.is_file():
            yield each


def _named(arguments: Sequence[str]) -> list[Path]:
    """Return the files that options name: profiles, cells, and plugins."""
    values = [each.rpartition("=")[2] for each in arguments]
    return [path for path in map(Path, values) if path.suffix and path.is_file()]


def _plugins() -> list[str]:
    """Return the installed plugins with their versions."""
    points = entry_points(group="amprep")
    return sorted(f"{each.name} {each.dist.version if each.dist else ''}" for each in points)
