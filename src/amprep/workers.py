"""Do independent tasks in several processes, with the results of one.

The number of processes belongs to the machine, not to the job: it changes the time, and no result. So it is no argument
of the functions that have tasks to share out; `allowed` sets it for all that is called in a block.
"""

import gc
import math
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
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from amprep import interruption

Result = TypeVar("Result")

_WORTH_IT = 30_000.0
"""Least work (in triangles, beyond the largest task) for which processes are made, in 0.05 s."""

_POLL_S = 0.1
_MOST_IDLE = 300
"""Polls in a row in which no worker used processor time, after which they count as hanging: 30 s."""
_HEAD = struct.Struct("=iq")
"""Number of the task, -1 for none that follows, and the number of bytes of its result, -1 for a failure."""

_LARGEST_QUEUE = 8_192
"""Largest number of tasks whose numbers fit into a pipe."""

_MOST_WORKERS = 256
"""Largest number of processes."""

_QUOTA = Path("/sys/fs/cgroup/cpu.max")
"""Where a container states how much processor time it may use in a period."""

_ALLOWED: ContextVar[int] = ContextVar("workers", default=1)

# Strategy. The process forks, so that tasks find all they need in memory, compiled kernels included: nothing is sent to
# a worker. The smallest task is done before, which loads the kernels once. The numbers of the others are in one pipe,
# the largest tasks first, from which each worker takes the next number when it is free. Each worker sends its results
# through a pipe of its own. Tasks that fail, and those of a worker that was killed, are done in this process at the
# end, in their order, so that an error is the same as with one process. So are those of workers that hang, for example
# at a lock that another thread of a compiled library held when the process forked: whoever waits uses no processor
# time. Polls are counted instead of seconds, because all processes may be suspended together. Workers ignore signals;
# they end when this process ends.


def available() -> int:
    """Return the number of cores that this process may use, by its affinity and the quota of its container."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with suppress(OSError, ValueError, ZeroDivisionError):
        quota, period = _QUOTA.read_text(encoding="ascii").split()
        cores = min(cores, max(1, math.ceil(int(quota) / int(period))))
    return cores


@contextmanager
def allowed(count: int) -> Iterator[None]:
    """Let what is called in the block use up to `count` processes; on systems other than Linux it uses one."""
    before = _ALLOWED.set(count)
    try:
        yield
    finally:
        _ALLOWED.reset(before)


def usable(tasks: int) -> int:
    """Return how many processes may do so many tasks, this one included if it does them alone."""
    return min(_ALLOWED.get(), tasks, _MOST_WORKERS) if sys.platform == "linux" else 1


def share_out(
    task: Callable[[int], Result],
    work: Sequence[float],
    *,
    all_long: bool = False,
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
    all_long
        Whether no task is short enough to be done before the others, to load kernels for them.
    is_cancelled
        Tells whether to end early; it is asked between tasks, and every 0.1 s while processes work.
    done
        Called with the number of tasks that are done.

    Raises
    ------
    Exception
        What a task raises.
    """
    workers = usable(len(work) if all_long else len(work) - 1)
    too_small = sum(work) - max(work, default=0.0) < _WORTH_IT
    numbers = range(len(work))
    results: dict[int, Result] = {}
    if workers > 1 and not too_small and len(work) <= _LARGEST_QUEUE and not is_cancelled():
        order = sorted(numbers, key=lambda number: (-work[number], number))
        if not all_long:
            with suppress(Exception):  # it is done again, in its order
                last = order.pop()
                results[last] = task(last)
        with _pool(task, order, workers) as pool:
            for number, found in pool.results(is_cancelled):
                results[number] = found
                done(len(results))
    _do_missing(task, numbers, results, is_cancelled, done)
    first_missing = next((number for number in numbers if number not in results), len(work))
    return [results[number] for number in range(first_missing)]


def _do_missing(
    task: Callable[[int], Result],
    numbers: Sequence[int],
    results: dict[int, Result],
    is_cancelled: Callable[[], bool],
    done: Callable[[int], None],
) -> None:
    """Do the tasks without a result, in this process and in their order."""
    for number in numbers:
        if number in results:
            continue
        if is_cancelled():
            return
        results[number] = task(number)
        done(len(results))


class _Workers(NamedTuple):
    """Worker processes: their numbers, by the pipes from them, and the pipes of those that are finished."""

    processes: dict[int, int]
    finished: set[int]

    def results(self, is_cancelled: Callable[[], bool]) -> Iterator[tuple[int, Any]]:
        """Yield the number and the result of each task when it is done; nothing for tasks that failed or were lost."""
        waiting, poll = set(self.processes), select.poll()
        idle, used = 0, 0
        for pipe in waiting:
            poll.register(pipe, select.POLLIN)
        while waiting and idle < _MOST_IDLE and not is_cancelled():
            ready, before = poll.poll(1000.0 * _POLL_S), used
            used = sum(_ticks_of(self.processes[pipe]) for pipe in waiting)
            idle = 0 if ready or used != before else idle + 1
            for pipe, _ in ready:
                head = _read(pipe, _HEAD.size)
                number, size = _HEAD.unpack(head) if head else (-1, 0)
                found = _read(pipe, size) if size > 0 else b""
                if size > 0 and found:
                    yield number, pickle.loads(found)  # noqa: S301 - our own
                if number < 0 or (size > 0 and not found):
                    waiting.remove(pipe)
                    poll.unregister(pipe)
                if head and number < 0:
                    self.finished.add(pipe)

    def end(self) -> None:
        """End all workers, whatever they do; other code of the program may have waited for them."""
        for pipe, process in self.processes.items():
            os.close(pipe)
            if pipe not in self.finished:
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
            with suppress(ChildProcessError):
                os.waitpid(process, 0)


def _ticks_of(process: int) -> int:
    """Return the processor time that a process has used, in ticks of the system; 0 if it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_bytes().rpartition(b")")[2].split()
        return int(fields[11]) + int(fields[12])
    except (OSError, ValueError, IndexError):
        return 0


@contextmanager
def _pool(task: Callable[[int], Any], numbers: Sequence[int], workers: int) -> Iterator[_Workers]:
    """Fork workers for the tasks of some numbers, as many as the system allows, and end them after the block."""
    pool, queue = _Workers({}, set()), -1
    try:
        with suppress(OSError):  # too many processes or open files: those that there are do the work
            queue, fill = os.pipe()
            os.write(fill, struct.pack(f"={len(numbers)}i", *numbers))
            os.close(fill)
            for _ in range(workers):
                _fork(task, queue, pool.processes)
        yield pool
    finally:
        if queue >= 0:
            os.close(queue)
        pool.end()


def _fork(task: Callable[[int], Any], queue: int, processes: dict[int, int]) -> None:
    """Start a worker, and note its process by the pipe with its results."""
    results, answers = os.pipe()
    parent = os.getpid()
    # a signal must not run the handlers of this process in the worker, nor come before the worker is noted
    before = signal.pthread_sigmask(signal.SIG_BLOCK, interruption.SIGNALS)
    try:
        with warnings.catch_warnings():
            # the threads that draw bars, and those of compiled libraries, hold no lock that a task needs
            warnings.simplefilter("ignore", DeprecationWarning)
            process = os.fork()
        if not process:
            _work(task, queue, answers, parent)
        processes[results] = process
    except OSError:
        os.close(results)
        raise
    finally:
        os.close(answers)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(task: Callable[[int], Any], queue: int, answers: int, parent: int) -> None:
    """Do tasks until none is left, and end this process."""
    try:
        for number in interruption.SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        interruption.end_with(parent, 1)
        _ALLOWED.set(1)
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
    except BaseException:  # noqa: BLE001 - whatever it is, it comes again in the process that forked
        return _HEAD.pack(number, -1), b""
    return _HEAD.pack(number, len(found)), found


def _write(pipe: int, *pieces: bytes) -> None:
    for piece in pieces:
        left = memoryview(piece)
        while left:
            left = left[os.write(pipe, left) :]


def _read(pipe: int, size: int) -> bytes:
    """Return so many bytes; none if the worker ended before."""
    pieces, missing = [], size
    while missing:
        piece = os.read(pipe, min(missing, 1 << 20))
        if not piece:
            return b""
        pieces.append(piece)
        missing -= len(piece)
    return b"".join(pieces)
