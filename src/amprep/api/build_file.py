"""Write a build job and verify it."""

from dataclasses import replace
from pathlib import Path

from amprep.api.arguments import require_record
from amprep.api.job import job_and_host
from amprep.errors import InputError
from amprep.job import Job
from amprep.measures.differences.find import find_differences
from amprep.measures.differences.records import BuildDifferences
from amprep.model import Build, Progress, Stop, silent
from amprep.pipeline.supporting import SupportedBuild
from amprep.pipeline.verifying.build import Verification, verify_build
from amprep.pipeline.verifying.file import Demands, verify_file


def write(build: SupportedBuild | Build, path: str | Path) -> Path:
    """Write a build job as a 3MF file and return its path.

    The file appears when it is complete, so an interrupted call leaves no file. Missing folders are created.

    Parameters
    ----------
    build
        A build from `emit_cells`.
    path
        File to write; it ends in ``.3mf``.

    Raises
    ------
    InputError
        When the path does not end in ``.3mf`` or cannot be written.

    Examples
    --------
    >>> amprep.write(supported, "out/bracket.build-1.3mf")
    PosixPath('out/bracket.build-1.3mf')
    """
    from amprep.threemf import write_build

    path = Path(path)
    if path.suffix.lower() != ".3mf":
        raise InputError(f"{path}: a build job must be a .3mf file; choose another name")
    require_record(build, (SupportedBuild, Build), "write", "pass the result of emit_cells")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
    write_build(build.build if isinstance(build, SupportedBuild) else build, path)
    return path


def verify(
    build: str | Path | SupportedBuild | Build,
    *,
    job: str | Path | Job | None = None,
    printer: str | None = None,
    report: str | Path | None = None,
    key: str | Path | None = None,
    removability: bool = False,
    stop: Stop | None = None,
    progress: Progress = silent,
) -> Verification:
    """Verify a build against every promise: from its file alone, as it is in memory, or against what was ordered.

    Parameters
    ----------
    build
        Path of a build job that amprep wrote, or a build from `emit_cells`.
    job
        The job that ordered the build: a job file, or a `Job`. The build is judged by its settings and its parts,
        instead of those that the file states.
    printer
        Name of the printer that will print the build, or path of its profile.
    report
        JSON report of the run, which states the SHA-256 of the file.
    key
        Key file of the seal beside the file; see `amprep seal`.
    removability
        Whether trapped powder and the access to contacts are judged as well, which takes long.
    stop
        Ends the work early.
    progress
        Called with the fraction that is done and a message.

    Raises
    ------
    InputError
        When the file is not a build job that amprep wrote, or the report, seal or key cannot be read; or when a build
        in memory is to be verified against a job, a printer, a report or a key.
    AmprepError
        When the job or the printer is wrong, or an input of the job cannot be read.

    Examples
    --------
    >>> print(amprep.verify("out/bracket.build-1.3mf"))
    every promise holds
    """
    if isinstance(build, str | Path):
        demands = replace(_demands(job, printer, report, key), removability=removability)
        return verify_file(Path(build), demands, stop=stop, progress=progress)
    require_record(build, (SupportedBuild, Build), "verify", "pass a path or the result of emit_cells")
    if any(each is not None for each in (job, printer, report, key)):
        raise InputError("job, printer, report and key apply to a build file; pass its path")
    judged = build.build if isinstance(build, SupportedBuild) else build
    return verify_build(judged, removability=removability, stop=stop, progress=progress)


def _demands(
    job: str | Path | Job | None, printer: str | None, report: str | Path | None, key: str | Path | None
) -> Demands:
    ordered = None if job is None else job_and_host((job,), {}, ())
    return Demands(ordered, printer, _path(report), _path(key))


def _path(file: str | Path | None) -> Path | None:
    return None if file is None else Path(file)


def diff(before: str | Path | Build, after: str | Path | Build) -> BuildDifferences:
    """Return in what a build differs from an earlier one; see `amprep.measures.differences.find.find_differences`.

    Parameters
    ----------
    before, after
        Build files that amprep wrote, or builds.

    Raises
    ------
    InputError
        When a file is not a build that amprep wrote.

    Examples
    --------
    >>> amprep.diff("monday.build-1.3mf", "tuesday.build-1.3mf").none
    False
    """
    from amprep.threemf import read_build

    builds = [each if isinstance(each, Build) else read_build(Path(each)) for each in (before, after)]
    return find_differences(*builds)
