"""The queue of a batch on a Dask cluster."""

import time
from typing import Any

from amprep import __version__
from amprep.batch.process import run_one
from amprep.batch.records import BatchJob, JobOutcome
from amprep.errors import AmprepError

MOST_LOSSES = 5
"""How often a job is given to the cluster after its worker was lost more often than Dask allows."""

_CONNECT_S = 20.0
_POLL_S = 0.05

# Strategy. A task of the cluster runs one job as `LocalQueue` does, in a process of its own that ends with the worker.
# Dask gives the task to another worker when one is lost; as a job writes all its files at once, and notes then that it
# is finished, nothing is lost and nothing is done twice. After four losses Dask gives up a task, because it may itself
# end the workers; a job cannot, so it is submitted again a few times.


class ClusterQueue:
    """Runs jobs on the workers of a Dask cluster, which must see the same files at the same paths.

    Parameters
    ----------
    address
        Address of the scheduler, for example ``tcp://host:8786``.
    again
        Whether finished jobs are run again.

    Raises
    ------
    AmprepError
        When the package ``distributed`` is missing, or no scheduler answers.
    """

    def __init__(self, address: str, *, again: bool) -> None:
        try:
            from distributed import Client
        except ImportError as error:
            message = "clusters need the package distributed; install it with: pip install 'amprep[cluster]'"
            raise AmprepError(message) from error
        try:
            self._client = Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise AmprepError(f"no scheduler answers at {address}: {error}") from error
        self._again = again
        self._jobs: dict[Any, BatchJob] = {}
        self._losses: dict[str, int] = {}

    def add(self, job: BatchJob) -> None:
        """Let a job wait for its turn."""
        future = self._client.submit(run_one, job, __version__, 1, again=self._again, pure=False)
        self._jobs[future] = job

    def outcomes(self, wait_s: float) -> list[JobOutcome]:
        """Return how jobs ended since the last call; wait at most so long for the first one."""
        until = time.monotonic() + wait_s
        while True:
            ended = [future for future in self._jobs if future.done()]
            if ended or not self._jobs or time.monotonic() >= until:
                break
            time.sleep(_POLL_S)
        found = [self._outcome(future, self._jobs.pop(future)) for future in ended]
        return [each for each in found if each is not None]

    @property
    def running(self) -> tuple[str, ...]:
        """Names of the jobs that run."""
        names = {future.key: job.name for future, job in self._jobs.items()}
        busy = self._client.processing()
        return tuple(names[key] for keys in busy.values() for key in keys if key in names)

    @property
    def left(self) -> int:
        """Number of jobs that have not ended."""
        return len(self._jobs)

    def end(self) -> None:
        """Cancel all jobs; those that run on workers end by themselves, with all their files."""
        self._client.cancel(list(self._jobs))
        self._client.close()

    def _outcome(self, future: Any, job: BatchJob) -> JobOutcome | None:
        """Return how a job ended; None if it is submitted again."""
        from distributed import KilledWorker

        try:
            found: JobOutcome = future.result()
        except KilledWorker:
            self._losses[job.name] = self._losses.get(job.name, 0) + 1
            if self._losses[job.name] <= MOST_LOSSES:
                self.add(job)
                return None
            message = "its worker was lost again and again"
        except Exception as error:  # noqa: BLE001 - whatever a worker raises costs this job alone
            message = " ".join(f"{type(error).__name__}: {error}".split())
        else:
            return found
        return JobOutcome(job.name, job.source, job.folder, "crashed", message)
