"""Watch a folder, and run the jobs that arrive in it."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from amprep import __version__
from amprep.batch.course import alone_in, ending, line_of
from amprep.batch.digest import files_of
from amprep.batch.find import find_jobs
from amprep.batch.queue import JobQueue
from amprep.batch.records import BatchJob, BatchRecord, JobOutcome
from amprep.batch.summary import write_summary
from amprep.errors import AmprepError, InputError
from amprep.interruption import raise_lost
from amprep.job import Job, job_of

SETTLED_S = 2.0
"""A job begins when none of its files has changed for this time, so that it does not read half a file."""

_BETWEEN_LOOKS_S = 1.0

Stamps = tuple[tuple[str, int, int], ...]
"""Path, size and time of change (ns) of each file of a job."""


class FolderWatch:
    """Finds the jobs in a folder that are complete and new.

    Parameters
    ----------
    folder, output, arguments
        As in `find_jobs`.
    settled_s
        Time for which the files of a job must not change.
    """

    def __init__(
        self, folder: Path, output: Path, arguments: Sequence[str], settled_s: float = SETTLED_S
    ) -> None:
        self._folder, self._output, self._arguments = folder, output, arguments
        self._settled_s = settled_s
        self._read: dict[Path, tuple[Stamps, Job | None]] = {}
        self._seen: dict[Path, tuple[Stamps, float]] = {}
        self._begun: dict[Path, Stamps] = {}

    def arrived(self, now: float) -> list[BatchJob]:
        """Return the jobs that are complete and have not begun in this state, at a time in seconds."""
        try:
            jobs = find_jobs([self._folder], self._output, self._arguments)
        except InputError:
            return []
        return [job for job in jobs if self._is_ready(job, now)]

    def _is_ready(self, job: BatchJob, now: float) -> bool:
        stamps = self._stamps(job.source)
        if stamps is None or self._begun.get(job.source) == stamps:
            return False
        before, since = self._seen.get(job.source, (None, now))
        if before != stamps:
            self._seen[job.source] = stamps, now
            return False
        if now - since < self._settled_s:
            return False
        self._begun[job.source] = stamps
        return True

    def _stamps(self, source: Path) -> Stamps | None:
        """Return the state of all files of a job, whose file is read only when it changed; None if one is missing."""
        own = _states([source])
        if own is None:
            return None
        if self._read.get(source, ((), None))[0] != own:
            self._read[source] = own, _job(source)
        job = self._read[source][1]
        with suppress(AmprepError):
            others = _states(files_of(job)) if job else ()
            return None if others is None else own + others
        return own


def watch_folder(
    watch: FolderWatch,
    queue: JobQueue,
    output: Path,
    *,
    idle_s: float | None,
    tell: Callable[[str], None],
) -> BatchRecord:
    """Run jobs that arrive until a signal comes, or until nothing has arrived for a time, and return how they ended.

    Parameters
    ----------
    watch
        Finds the jobs.
    queue
        Runs them.
    output
        Folder of the summary, which is written whenever a job ends.
    idle_s
        Time without a job after which to end; None for never.
    tell
        Called with one line for each job that begins or ends.

    Raises
    ------
    AmprepError
        If the summary cannot be written, or another batch writes to the output folder.
    Interrupted
        After a signal; the jobs that ran are ended.
    """
    begin = busy = time.monotonic()
    found: dict[str, JobOutcome] = {}
    waiting: dict[str, BatchJob] = {}
    with alone_in(output), ending(queue, lambda: write_summary(_record(found, begin), output)):
        while queue.left or idle_s is None or time.monotonic() - busy < idle_s:
            raise_lost()
            for job in watch.arrived(time.monotonic()):
                if job.name not in waiting:
                    tell(f"{job.name}: arrived")
                    waiting[job.name] = job
                    queue.add(job)
            for outcome in _waited(queue):
                busy = time.monotonic()
                found[outcome.name] = outcome
                waiting.pop(outcome.name)
                tell(f"{outcome.name}: done" if outcome.state == "done" else line_of(outcome))
                write_summary(_record(found, begin), output)
            busy = time.monotonic() if queue.left else busy
        return write_summary(_record(found, begin), output)


def _waited(queue: JobQueue) -> list[JobOutcome]:
    """Return the jobs that ended within a second, and wait at least so long if none did."""
    begin = time.monotonic()
    outcomes = queue.outcomes(_BETWEEN_LOOKS_S)
    if not outcomes:
        time.sleep(max(0.0, _BETWEEN_LOOKS_S - (time.monotonic() - begin)))
    return outcomes


def _record(found: dict[str, JobOutcome], begin: float) -> BatchRecord:
    return BatchRecord(__version__, tuple(found.values()), time.monotonic() - begin)


def _states(files: Sequence[Path]) -> Stamps | None:
    """Return path, size and time of change of each file; None while one of them is missing."""
    try:
        states = [(path, path.stat()) for path in files]
    except OSError:
        return None
    return tuple((str(path), state.st_size, state.st_mtime_ns) for path, state in states)


def _job(source: Path) -> Job | None:
    """Return the job of a file; None if it is wrong: it runs, so that its error is shown."""
    with suppress(AmprepError):
        return job_of([str(source)])
    return None
