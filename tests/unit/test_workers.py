import os
import signal
import time
from contextlib import suppress
from pathlib import Path

import pytest

from amprep import workers
from amprep.errors import JobError
from amprep.workers import allowed, share_out

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="workers are forked")

LARGE = [1e6] * 6


def children() -> set[str]:
    """Numbers of the processes that this one started and that are there, as Linux says."""
    found = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            if (
                int(stat.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()[1])
                == os.getpid()
            ):
                found.add(stat.parent.name)
    return found


def process_of(number: int) -> tuple[int, int]:
    time.sleep(0.1)  # every worker gets a task, even on a loaded machine
    return number * number, os.getpid()


def test_results_come_in_the_order_of_the_tasks_from_several_processes() -> None:
    with allowed(3):
        found = share_out(process_of, [1e6, 3e6, 2e6, 5e6, 1e5, 4e6])
    assert [value for value, _ in found] == [0, 1, 4, 9, 16, 25]
    processes = {process for _, process in found}
    assert len(processes - {os.getpid()}) >= 2
    assert found[4][1] == os.getpid()  # the smallest task loads what the others need


@pytest.mark.parametrize(("count", "work"), [(1, LARGE), (4, [10.0] * 6), (4, [1e9, 10.0, 10.0])])
def test_one_process_does_small_work_and_all_work_by_default(count: int, work: list[float]) -> None:
    with allowed(count):
        found = share_out(process_of, work)
    assert {process for _, process in found} == {os.getpid()}
    assert {process for _, process in share_out(process_of, LARGE)} == {os.getpid()}


def test_large_results_arrive_whole() -> None:
    with allowed(2):
        found = share_out(lambda number: bytes([number]) * 3_000_000, LARGE)
    assert [(len(each), each[:1]) for each in found] == [(3_000_000, bytes([number])) for number in range(6)]


def test_the_error_of_a_task_is_raised_as_it_is() -> None:
    def fails(number: int) -> int:
        if number == 3:
            raise JobError("the fourth cell is wrong")
        return number

    with allowed(2), pytest.raises(JobError, match="the fourth cell is wrong"):
        share_out(fails, LARGE)


def test_a_result_that_cannot_be_sent_is_made_in_this_process() -> None:
    with allowed(2):
        found = share_out(lambda number: lambda: number, LARGE)
    assert [each() for each in found] == list(range(6))


@pytest.mark.parametrize("dying", [{3}, set(range(6))])
def test_the_tasks_of_workers_that_die_are_done_in_this_process(dying: set[int]) -> None:
    me = os.getpid()

    def dies(number: int) -> int:
        if os.getpid() != me and number in dying:
            os.kill(os.getpid(), signal.SIGKILL)
        return number

    with allowed(2):
        assert share_out(dies, LARGE) == list(range(6))


@pytest.mark.parametrize("hanging", [{5}, set(range(1, 6))])
def test_the_tasks_of_workers_that_hang_are_done_in_this_process(
    hanging: set[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    me, before = os.getpid(), children()
    monkeypatch.setattr(workers, "_MOST_IDLE", 3)

    def hangs(number: int) -> int:
        if os.getpid() != me and number in hanging:
            signal.pause()
        return number

    with allowed(2):
        assert share_out(hangs, LARGE) == list(range(6))
    assert children() == before


def test_a_process_that_works_uses_processor_time() -> None:
    before, until = workers._ticks_of(os.getpid()), time.process_time() + 0.05
    while time.process_time() < until:
        pass
    assert workers._ticks_of(os.getpid()) > before
    assert workers._ticks_of(2**30) == 0


def test_of_several_errors_the_one_of_the_first_task_is_raised() -> None:
    def fails(number: int) -> int:
        time.sleep(0.05 if number == 1 else 0.0)
        raise JobError(f"task {number}")

    for count in (1, 3):
        with allowed(count), pytest.raises(JobError, match="task 0"):
            share_out(fails, LARGE)


def test_without_further_processes_this_one_does_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused() -> int:
        raise BlockingIOError("no more processes")

    monkeypatch.setattr(os, "fork", refused)
    before = len(list(Path("/proc/self/fd").iterdir()))
    with allowed(4):
        assert [value for value, _ in share_out(process_of, LARGE)] == [0, 1, 4, 9, 16, 25]
    assert len(list(Path("/proc/self/fd").iterdir())) == before


def test_programs_that_ignore_the_end_of_their_children_get_all_results() -> None:
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        with allowed(2):
            assert len(share_out(process_of, LARGE)) == 6
    finally:
        signal.signal(signal.SIGCHLD, before)


@pytest.mark.parametrize(("text", "most"), [("150000 100000\n", 2), ("max 100000\n", 10_000), ("", 10_000)])
def test_the_quota_of_a_container_limits_the_cores(text, most, tmp_path, monkeypatch) -> None:
    (tmp_path / "cpu.max").write_text(text, encoding="ascii")
    monkeypatch.setattr(workers, "_QUOTA", tmp_path / "cpu.max")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(10_000)))
    assert workers.available() == most


def test_a_signal_does_not_run_the_handlers_of_this_process_in_workers() -> None:
    me = os.getpid()

    def interrupted(number: int) -> int:
        if os.getpid() != me:
            os.kill(os.getpid(), signal.SIGTERM)
        return number

    with allowed(2):
        assert share_out(interrupted, LARGE) == list(range(6))


def test_when_cancelled_the_first_results_are_returned_and_no_worker_stays() -> None:
    done: list[int] = []
    before = children()
    with allowed(2):
        found = share_out(process_of, LARGE, is_cancelled=lambda: len(done) >= 3, done=done.append)
    assert [value for value, _ in found] == [number * number for number in range(len(found))]
    assert len(found) < len(LARGE)
    assert children() == before


def test_the_number_of_processes_holds_in_its_block_alone() -> None:
    with allowed(5):
        assert workers._ALLOWED.get() == 5
    assert workers._ALLOWED.get() == 1
    assert workers.available() >= 1
