"""Signals wait while files appear; the first one ends a run, the second one ends the process."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from amprep import interruption
from amprep.pipeline.stages import Clock, ProgressWatcher


@pytest.fixture(autouse=True)
def _handlers(monkeypatch):
    """Restore the handlers and the state of the process."""
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    before = {number: signal.getsignal(number) for number in interruption.SIGNALS}
    yield
    interruption.watch()
    for number, handler in before.items():
        signal.signal(number, handler)
    interruption._STATE.watching = False


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_a_signal_ends_the_run_and_its_number_gives_the_exit_code(number):
    interruption.watch()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(number)
    assert interruption.received() == number
    assert interruption.exit_code() == 128 + number


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_a_signal_waits_until_a_block_ends(number):
    interruption.watch()
    reached = []

    def block():
        with interruption.held():
            signal.raise_signal(number)
            reached.append("the end of the block")

    with pytest.raises(KeyboardInterrupt):
        block()
    assert reached == ["the end of the block"]


def test_a_signal_while_files_appear_changes_nothing_and_is_noted():
    interruption.watch()
    with interruption.held():
        signal.raise_signal(signal.SIGTERM)
        interruption.files_appeared()
    assert interruption.received() is None
    assert interruption.came_late() == signal.SIGTERM


def test_handlers_of_another_program_get_their_signal_after_the_block():
    got = []
    signal.signal(signal.SIGINT, lambda number, _: got.append(number))
    with interruption.held():
        signal.raise_signal(signal.SIGINT)
        assert got == []
    assert got == [signal.SIGINT]


def test_another_thread_may_hold_signals():
    thread = threading.Thread(target=lambda: interruption.held().__enter__())
    thread.start()
    thread.join()
    assert signal.getsignal(signal.SIGINT) is not None


def test_an_interrupt_without_a_signal_is_raised_by_code():
    assert not interruption.is_raised_by_code()
    interruption.watch()
    assert interruption.is_raised_by_code()


def test_signals_are_ignored_when_the_result_is_known(monkeypatch):
    monkeypatch.setattr("atexit.register", lambda function: function())
    interruption.watch()
    interruption.end()
    for number in interruption.SIGNALS:
        assert signal.getsignal(number) is signal.SIG_IGN
        interruption._handle(number, None)
    assert interruption.received() is None


def test_a_signal_cleans_up_and_ends_the_process_before_any_exception_unwinds_it():
    done = []

    def end(clean):
        clean()
        done.append("ended")

    interruption.watch(end)
    interruption.clean_with(lambda: done.append("cleaned"))
    with pytest.raises(KeyboardInterrupt):  # here `end` returns
        signal.raise_signal(signal.SIGTERM)
    assert done == ["cleaned", "ended"]


def test_where_nothing_is_to_be_cleaned_the_exception_ends_the_run():
    interruption.watch(lambda _: pytest.fail("the process ends without its clean-up"))
    interruption.clean_with(lambda: None)
    interruption.clean_with(None)
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_a_second_signal_ends_code_that_catches_everything():
    stubborn = (
        "import os, signal, time\n"
        "from amprep import interruption\n"
        "interruption.watch(); interruption.REPEATED_AFTER_S = 0.0\n"
        "for _ in range(2):\n"
        "    try: signal.raise_signal(signal.SIGTERM)\n"
        "    except BaseException: pass\n"
        "print('still here')"
    )
    ended = subprocess.run(
        [sys.executable, "-c", stubborn], capture_output=True, text=True, check=False, env=dict(os.environ)
    )
    assert (ended.returncode, ended.stdout) == (143, "")
    assert ended.stderr == "amprep: interrupted; nothing was written\n"


def test_an_interruption_that_python_drops_is_raised_again_and_not_told(capsys):
    interruption.watch()
    interruption.raise_lost()

    class Dropping:
        def __del__(self):
            signal.raise_signal(signal.SIGTERM)

    Dropping()  # its interruption is dropped
    assert interruption.received() == signal.SIGTERM
    assert capsys.readouterr().err == ""
    with pytest.raises(KeyboardInterrupt):
        interruption.raise_lost()
    with pytest.raises(KeyboardInterrupt), Clock(ProgressWatcher()).stage("pack"):
        raise AssertionError("no stage begins after an interruption")
    interruption.files_appeared()
    interruption.raise_lost()


def test_other_exceptions_that_python_drops_are_told(monkeypatch):
    told = []
    monkeypatch.setattr(sys, "unraisablehook", lambda lost: told.append(str(lost.exc_value)))
    interruption.watch()

    class Failing:
        def __del__(self):
            raise ValueError("dropped")

    Failing()
    assert told == ["dropped"]
