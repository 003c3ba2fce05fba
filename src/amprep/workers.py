"""Do independent tasks in several processes, with the results of one.

The number of processes belongs to the machine, not to the job: it changes the time, and no result. So it is no argument
of the functions that have tasks to share out; `allowed` sets it for all that is called in a block.
"""

import gc
import os
import pickle
import select
import signal
import struct
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import Any, NamedTuple, TypeVar

from amprep import interruption
from amprep.errors import AmprepError

Result = TypeVar("Result")

_WORTH_IT = 30_000.0
"""Least work (in triangles, beyond the largest task) for which processes are made, in 0.05 s."""

_POLL_S = 0.1
_HEAD = struct.Struct("=iq")
"""Number of the task, -1 for none that follows, and the number of bytes of its result, -1 for a failure."""

_LARGEST_QUEUE = 8_192
"""Largest number of tasks whose numbers fit into a pipe."""

_ALLOWED: ContextVar[int] = ContextVar("workers", default=1)

# Strategy. The process forks, so that tasks find all they need in memory, compiled kernels included: nothing is sent to
# a worker. The smallest task is done before, which loads the kernels once. The numbers of the others are in one pipe,
# the largest tasks first, from which each worker takes the next number when it is free. Each worker sends its results
# through a pipe of its own. A task that fails is done again in this process, so that its error is the same as with one
# process. Workers ignore signals; they end when this process ends.


class WorkerLost(AmprepError):
    """A worker process ended before its work was done."""


def available() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def allowed(count: int) -> Iterator[None]:
    """Let what is called in the block use up to `count` processes; on systems other than Linux it uses one."""
    before = _ALLOWED.set(count)
    try:
        yield
    finally:
        _ALLOWED.reset(before)


def share_out(
    task: Callable[[int], Result],
    work: Sequence[float],
    *,
    is_cancelled: Callable[[], bool] = lambda: False,
    done: Callable[[int], None] = lambda _: None,
) -> list[Result]:
    """Return the results of ``task(0)``, ``task(1)`` and so on; when cancelled, only the first of them.

    Parameters
    ----------
    task
        Does the task of a number. It depends on nothing but that, calls no plugin, and returns what pickle can store.
    work
        Estimated work of each task, in triangles.
    is_cancelled
        Tells whether to end early; it is asked between tasks.
    done
        Called with the number of tasks that are done.

    Raises
    ------
    WorkerLost
        When a worker ends unexpectedly, for example because memory ran out.
    Exception
        What a task raises.
    """
    workers = min(_ALLOWED.get(), len(work) - 1)
    too_small = sum(work) - max(work, default=0.0) < _WORTH_IT
    if workers < 2 or too_small or len(work) > _LARGEST_QUEUE or sys.platform != "linux":
        return _one_by_one(task, len(work), is_cancelled, done)
    order = sorted(range(len(work)), key=lambda number: (-work[number], number))
    results: dict[int, Result] = {order[-1]: task(order[-1])}
    done(1)
    with _pool(task, order[:-1], workers) as pool:
        for number, found in pool.results(is_cancelled):
            results[number] = task(number) if found is None else found.value
            done(len(results))
    first_missing = next((number for number in range(len(work)) if number not in results), len(work))
    return [results[number] for number in range(first_missing)]


def _one_by_one(
    task: Callable[[int], Result], count: int, is_cancelled: Callable[[], bool], done: Callable[[int], None]
) -> list[Result]:
    results: list[Result] = []
    while len(results) < count and not is_cancelled():
        results.append(task(len(results)))
        done(len(results))
    return results


class _TaskResult(NamedTuple):
    """The result of a task."""

    value: Any


class _Workers(NamedTuple):
    """Worker processes: their numbers, and the pipe from each."""

    processes: dict[int, int]

    def results(self, is_cancelled: Callable[[], bool]) -> Iterator[tuple[int, _TaskResult | None]]:
        """Yield the number and the result of each task when it is done; None for a task that failed."""
        waiting = set(self.processes)
        while waiting and not is_cancelled():
            for pipe in select.select(list(waiting), [], [], _POLL_S)[0]:
                number, size = _HEAD.unpack(_read(pipe, _HEAD.size))
                if number < 0:
                    waiting.remove(pipe)
                else:
                    yield number, None if size < 0 else _TaskResult(pickle.loads(_read(pipe, size)))  # noqa: S301 - our own

    def end(self) -> None:
        """End all workers, whatever they do."""
        for pipe, process in self.processes.items():
            os.close(pipe)
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)


@contextmanager
def _pool(task: Callable[[int], Any], numbers: Sequence[int], workers: int) -> Iterator[_Workers]:
    """Fork workers for the tasks of some numbers, and end them after the block."""
    queue, fill = os.pipe()
    os.write(fill, struct.pack(f"={len(numbers)}i", *numbers))
    os.close(fill)
    pool = _Workers({})
    try:
        for _ in range(workers):
            pipe, process = _fork(task, queue)
            pool.processes[pipe] = process
        yield pool
    finally:
        os.close(queue)
        pool.end()


def _fork(task: Callable[[int], Any], queue: int) -> tuple[int, int]:
    """Start a worker; return the pipe with its results, and its process."""
    results, answers = os.pipe()
    parent = os.getpid()
    # a signal must not run the handlers of this process in the worker
    before = signal.pthread_sigmask(signal.SIG_BLOCK, interruption.SIGNALS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", DeprecationWarning
            )  # the thread that draws bars holds no lock here
            process = os.fork()
        if not process:
            _work(task, queue, answers, parent)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    os.close(answers)
    return results, process


def _work(task: Callable[[int], Any], queue: int, answers: int, parent: int) -> None:
    """Do tasks until none is left, and end this process."""
    try:
        for number in interruption.SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        interruption.end_with(parent, 1)
        gc.disable()  # a collection would copy memory that is shared with the other processes
        while len(taken := os.read(queue, 4)) == 4:
            (number,) = struct.unpack("=i", taken)
            _write(answers, *_answer(task, number))
        _write(answers, _HEAD.pack(-1, 0))
    finally:
        os._exit(0)


def _answer(task: Callable[[int], Any], number: int) -> tuple[bytes, bytes]:
    """Return the head and the result of a task."""
    try:
        found = pickle.dumps(task(number), protocol=5)
    except BaseException:  # noqa: BLE001 - whatever it is, it comes again in the other process
        return _HEAD.pack(number, -1), b""
    return _HEAD.pack(number, len(found)), found


def _write(pipe: int, *pieces: bytes) -> None:
    for piece in pieces:
        left = memoryview(piece)
        while left:
            left = left[os.write(pipe, left) :]


def _read(pipe: int, size: int) -> bytes:
    pieces, missing = [], size
    while missing:
        piece = os.read(pipe, min(missing, 1 << 20))
        if not piece:
            raise WorkerLost(
                "a worker process ended unexpectedly, perhaps because memory ran out; try --workers 1"
            )
        pieces.append(piece)
        missing -= len(piece)
    return b"".join(pieces)
