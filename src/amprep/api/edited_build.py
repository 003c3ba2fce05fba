"""Plan a build again that was edited in another program."""

from collections.abc import Sequence
from pathlib import Path

from amprep.api.job import job_and_host
from amprep.host import Host
from amprep.job import Job
from amprep.model import Progress, Stop, silent
from amprep.pipeline.replanning.course import ReplanOptions, replan_build
from amprep.pipeline.stages import ProgressWatcher, Watcher
from amprep.report.replanning import ReplanRecord


def replan(
    build: str | Path,
    *,
    output: str | Path,
    job: str | Path | Job | None = None,
    report: str | Path | None = None,
    dry_run: bool = False,
    verify_all: bool = False,
    time_limit_s: float | None = None,
    page: bool = False,
    force: bool = False,
    plugins: Host | Sequence[str] = (),
    stop: Stop | None = None,
    progress: Progress = silent,
    watcher: Watcher | None = None,
) -> ReplanRecord:
    """Plan a build again after parts were moved, turned, deleted, copied or added, as ``amprep replan`` does.

    Supports that still hold are kept; the others are planned again, by the settings that the build file records.

    Parameters
    ----------
    build
        The edited file.
    output
        Folder for ``NAME.replanned.3mf`` and ``NAME.replanned.report.json``.
    job
        The job by which supports are planned, instead of the recorded settings.
    report
        JSON report of the run that made the build, beside the build file; for files without a record.
    dry_run
        Whether everything is planned and verified, but nothing is written.
    verify_all
        Whether supports that are kept are judged as well.
    time_limit_s
        Seconds after which routing ends with its best result so far; None for no limit.
    page
        Whether ``NAME.replanned.report.html`` is written, too: the page that `run` gives.
    force
        Whether a ``NAME.replanned.3mf`` is replaced that was changed since it was planned again.
    plugins, stop, progress, watcher
        As in `run`.

    Raises
    ------
    AmprepError
        When the file cannot be read, when nothing says what it was made from, when a part is outside the build volume
        or too near to another, when the new file would replace a changed one, or when a plugin fails.

    Examples
    --------
    >>> record = amprep.replan("bracket.build-1.3mf", output="out")
    >>> record.file
    'bracket.build-1.replanned.3mf'
    """
    ordered, host = (
        (None, job_and_host((), {}, plugins, default="replan")[1])
        if job is None
        else (job_and_host((job,), {}, plugins))
    )
    known = None if report is None else Path(report)
    options = ReplanOptions(Path(output), known, dry_run, verify_all, time_limit_s, page, force)
    return replan_build(
        Path(build),
        options,
        job=ordered,
        host=host,
        watcher=watcher or ProgressWatcher(progress),
        stop=stop or Stop(),
    )
