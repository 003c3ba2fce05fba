"""The queue of a batch, and its form on this machine: several processes side by side."""

import time
from collections import deque
from typing import Protocol

from amprep import workers
from amprep.batch.digest import with_digest
from amprep.batch.finished import finished_before
from amprep.batch.process import JobProcess
from amprep.batch.records import BatchJob, JobOutcome

_POLL_S = 0.05


class JobQueue(Protocol):
    """Runs jobs in the order in which they are added, several at a time."""

    def add(self, job: BatchJob) -> None:
        """Let a job wait for its turn."""

    def outcomes(self, wait_s: float) -> list[JobOutcome]:
        """Return how jobs ended since the last call; wait at most so long for the first one."""

    @property
    def running(self) -> tuple[str, ...]:
        """Names of the jobs that run."""

    @property
    def left(self) -> int:
        """Number of jobs that have not ended."""

    def end(self) -> None:
        """End all jobs that run; those that wait do not begin."""


class LocalQueue:
    """Runs jobs in processes of this machine.

    Parameters
    ----------
    count
        Largest number of jobs that run at the same time. A job alone uses all cores, and each of several its share.
    again
        Whether finished jobs are run again.
    """

    def __init__(self, count: int, *, again: bool) -> None:
        self._count, self._again = count, again
        self._waiting: deque[BatchJob] = deque()
        self._processes: list[JobProcess] = []

    def add(self, job: BatchJob) -> None:
        """Let a job wait for its turn."""
        self._waiting.append(job)

    def outcomes(self, wait_s: float) -> list[JobOutcome]:
        """Return how jobs ended since the last call; wait at most so long for the first one."""
        until, found = time.monotonic() + wait_s, self._begin()
        while True:
            ended = [each for each in self._processes if each.ended]
            self._processes = [each for each in self._processes if each not in ended]
            found += [each.outcome() for each in ended]
            found += self._begin()
            if found or time.monotonic() >= until or not self._processes:
                return found
            time.sleep(_POLL_S)

    @property
    def running(self) -> tuple[str, ...]:
        """Names of the jobs that run."""
        return tuple(each.job.name for each in self._processes)

    @property
    def left(self) -> int:
        """Number of jobs that have not ended."""
        return len(self._waiting) + len(self._processes)

    def end(self) -> None:
        """End all jobs that run; those that wait do not begin."""
        self._waiting.clear()
        for each in self._processes:
            each.end()
        self._processes.clear()

    def _begin(self) -> list[JobOutcome]:
        """Begin jobs while there is room; return those that an earlier batch finished, or that cannot begin."""
        ended = []
        while self._waiting and len(self._processes) < self._count:
            job = with_digest(self._waiting.popleft())
            found = None if self._again else finished_before(job)
            if found is not None:
                ended.append(found)
                continue
            side_by_side = min(self._count, len(self._waiting) + len(self._processes) + 1)
            try:
                self._processes.append(JobProcess(job, max(1, workers.available() // side_by_side)))
            except OSError as error:
                message = f"its process cannot be started: {error.strerror or error}"
                ended.append(JobOutcome(job.name, job.source, job.folder, "crashed", message))
        return ended
