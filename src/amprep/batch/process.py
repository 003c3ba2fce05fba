"""Run one job in a process of its own, and find out how it ended."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from tempfile import TemporaryFile
from typing import Any

from amprep import __version__
from amprep.batch.digest import with_digest
from amprep.batch.finished import finished_before, json_object, note_finished
from amprep.batch.records import BatchJob, JobFigures, JobOutcome, State
from amprep.errors import AmprepError
from amprep.pipeline.outputs import REPORTS, safe_name
from amprep.supervision import INCOMPLETE, WRONG

_LONGEST_MESSAGE = 500
_GRACE_S = 10.0
"""Time that a job has to end after it was asked to."""

# Strategy. A job runs as `amprep run` does when a user calls it, in a new process: so its files are the same, and
# a crash, a full memory or a hook that ends the process costs this job alone. Its output goes to a file without
# a name, because a pipe that nobody reads would stop it. It ends when this process ends (Linux).


class JobProcess:
    """A job that runs.

    Parameters
    ----------
    job
        The job.
    workers
        Largest number of processes that it may use itself.

    Raises
    ------
    OSError
        If the system starts no process.
    """

    def __init__(self, job: BatchJob, workers: int) -> None:
        self.job, self._begin = job, time.monotonic()
        self._answer, self._errors = TemporaryFile(), TemporaryFile()  # noqa: SIM115 - closed by `outcome` and `end`
        try:
            self._process = subprocess.Popen(  # noqa: S603 - our own command; no shell
                command_of(job, workers), stdin=subprocess.DEVNULL, stdout=self._answer, stderr=self._errors
            )
        except OSError:
            self._close()
            raise

    @property
    def ended(self) -> bool:
        """Whether the process ended."""
        return self._process.poll() is not None

    def outcome(self) -> JobOutcome:
        """Wait for the end of the process, and return how the job ended; finished jobs are noted in their folder."""
        code = self._process.wait()
        answer, errors = _contents(self._answer), _contents(self._errors)
        report = json_object(answer)
        state = _state(code, report)
        message = "" if state == "done" else _message(code, state, errors)
        seconds = time.monotonic() - self._begin
        files = tuple(_files(self.job, report))
        figures = _figures(report)
        found = JobOutcome(
            self.job.name, self.job.source, self.job.folder, state, message, figures, files, seconds
        )
        with suppress(AmprepError, OSError):  # then the next batch runs the job again
            note_finished(self.job, found)
        return found

    def end(self) -> None:
        """End the job: it leaves no file, unless its files had appeared."""
        self._process.terminate()
        try:
            self._process.wait(_GRACE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._close()

    def _close(self) -> None:
        self._answer.close()
        self._errors.close()


def command_of(job: BatchJob, workers: int) -> list[str]:
    """Return the command that runs a job in a process that ends with this one."""
    command = [sys.executable, "-m", "amprep.cli.owned", str(os.getpid()), "run", str(job.source)]
    options = ["-o", str(job.folder), "--json", "--quiet", "--workers", str(workers)]
    return [*command, *options, *job.arguments]


def run_one(job: BatchJob, version: str, workers: int, *, again: bool) -> JobOutcome:
    """Run a job and return how it ended, unless an earlier batch finished it; a worker of a cluster calls this.

    Parameters
    ----------
    job
        The job; its files are at the same paths on every machine.
    version
        Version of amprep that the batch has; this process must have the same.
    workers
        Largest number of processes that the job may use.
    again
        Whether finished jobs are run again.
    """
    if version != __version__:
        message = f"a worker has amprep {__version__}, expected {version}"
        return JobOutcome(job.name, job.source, job.folder, "crashed", message)
    job = with_digest(job)
    earlier = None if again else finished_before(job)
    return earlier or JobProcess(job, workers).outcome()


def _contents(file: Any) -> str:
    with file:
        file.seek(0)
        return str(file.read().decode("utf-8", "replace"))


def _state(code: int, report: dict[str, Any]) -> State:
    if code == 0 and report:
        return "done"
    if code == INCOMPLETE and report:
        return "incomplete"
    return "refused" if code == WRONG else "crashed"


def _message(code: int, state: State, errors: str) -> str:
    """Return what went wrong: the last line of the errors, or the signal that ended the process."""
    if state == "incomplete":
        return ""
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        memory = "; the system may have run out of memory" if -code == signal.SIGKILL else ""
        return f"its process was ended by {name}{memory}"
    lines = [line for line in errors.splitlines() if line.strip()]
    last = (
        lines[-1].removeprefix("amprep: ") if lines else f"it ended with exit code {code} without a message"
    )
    return "".join(each if each.isprintable() else " " for each in last)[:_LONGEST_MESSAGE]


def _figures(report: dict[str, Any]) -> JobFigures:
    if not report:
        return JobFigures()
    builds, triage = report["builds"], report["triage"]
    parts = sum(len(build["parts"]) for build in builds)
    return JobFigures(
        len(builds), parts, len(report["unplaced"]), triage["must_fix"], triage["worth_a_check"]
    )


def _files(job: BatchJob, report: dict[str, Any]) -> list[str]:
    """Return the names of the files that a run wrote, its builds first."""
    builds, name = report.get("builds", []), safe_name(str(report.get("job", "")))
    names = [build.get(key) for build in builds for key in ("file", "picture")]
    names += [stl for build in builds for stl in build.get("stl_files", [])]
    names += [f"{name}.{suffix}" for suffix in REPORTS]
    return [each for each in names if each and (job.folder / each).is_file()]
