"""Run the jobs of a batch, and write its summary whenever a job ends."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from amprep import __version__
from amprep.batch.queue import JobQueue
from amprep.batch.records import BatchJob, BatchRecord, JobOutcome
from amprep.batch.summary import write_summary
from amprep.errors import AmprepError, Interrupted
from amprep.files import held_alone
from amprep.interruption import raise_lost
from amprep.model.control import Progress

_LOCK = ".amprep-batch"
_WAIT_S = 0.2
_BETWEEN_SUMMARIES_S = 2.0


def run_batch(
    jobs: Sequence[BatchJob],
    queue: JobQueue,
    output: Path,
    *,
    progress: Progress,
    tell: Callable[[str], None],
) -> BatchRecord:
    """Run all jobs and return how they ended, in their order.

    The summary in the output folder is complete at every moment; a batch that ended early is continued when it is
    started again.

    Parameters
    ----------
    jobs
        The jobs.
    queue
        Runs them.
    output
        Folder of the summary; it is made if it does not exist.
    progress
        Called with the fraction of jobs that have ended, and the names of those that run.
    tell
        Called with one line for each job that is not done.

    Raises
    ------
    AmprepError
        If the summary cannot be written, or another batch writes to the output folder.
    Interrupted
        After a signal; the jobs that ran are ended, and the summary is written.
    """
    begin, written, found = time.monotonic(), 0.0, dict[str, JobOutcome]()

    def so_far() -> BatchRecord:
        return write_summary(_record(jobs, found, begin), output)

    with alone_in(output), ending(queue, so_far):
        for job in jobs:
            queue.add(job)
        while queue.left:
            raise_lost()
            for outcome in queue.outcomes(_WAIT_S):
                found[outcome.name] = outcome
                if outcome.state != "done":
                    tell(line_of(outcome))
            progress(len(found) / len(jobs), f"{len(found)} of {len(jobs)} jobs; {', '.join(queue.running)}")
            if time.monotonic() - written > _BETWEEN_SUMMARIES_S:
                so_far()
                written = time.monotonic()
        return so_far()


@contextmanager
def ending(queue: JobQueue, write: Callable[[], BatchRecord]) -> Iterator[None]:
    """End the jobs of a queue after the block; after a signal, write the summary first.

    Raises
    ------
    Interrupted
        After a signal.
    """
    try:
        yield
    except KeyboardInterrupt as error:
        queue.end()
        record = write()
        ended = sum(each.state != "not run" for each in record.outcomes)
        raise Interrupted(
            f"interrupted; {ended} of {len(record.outcomes)} jobs have ended, and their files are complete; "
            "the same command runs the others"
        ) from error
    finally:
        queue.end()


def line_of(outcome: JobOutcome) -> str:
    """Return what a user should know about a job that is not done, in one line."""
    if outcome.state == "incomplete":
        figures = outcome.figures
        return f"{outcome.name}: incomplete: {figures.unplaced} unplaced, {figures.must_fix} must be fixed"
    return f"{outcome.name}: {outcome.state}: {outcome.message}"


def _record(jobs: Sequence[BatchJob], found: dict[str, JobOutcome], begin: float) -> BatchRecord:
    outcomes = tuple(
        found.get(job.name) or JobOutcome(job.name, job.source, job.folder, "not run") for job in jobs
    )
    return BatchRecord(__version__, outcomes, time.monotonic() - begin)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Make the output folder, and let no other batch write to it in the block: both would run each job.

    Raises
    ------
    AmprepError
        If that is not possible, or another batch writes to the folder.
    """
    with ExitStack() as held:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            is_alone = held.enter_context(held_alone(folder / _LOCK))
        except OSError as error:
            raise AmprepError(
                f"cannot write to the output folder {folder}: {error.strerror or error}"
            ) from error
        if not is_alone:
            raise AmprepError(
                f"another batch writes to {folder}; wait until it has ended, or choose another folder by -o"
            )
        yield
