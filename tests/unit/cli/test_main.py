"""The command line turns every error into one line and an exit code; with --debug the error itself appears."""

import signal
import subprocess
import sys

import pytest

import amprep.cli.app
from amprep import interruption
from amprep.cli import DONE, INCOMPLETE, WRONG, main
from amprep.errors import InputError


@pytest.fixture
def run(monkeypatch, capsys):
    """Return a function that runs the command line with an app that raises an error."""

    def call(error, *arguments):
        def app():
            if error is not None:
                raise error

        monkeypatch.setattr(amprep.cli.app, "app", app)
        monkeypatch.setattr("sys.argv", ["amprep", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        return end.value.code, capsys.readouterr().err

    before = {number: signal.getsignal(number) for number in interruption.SIGNALS}
    yield call
    for number, handler in before.items():
        signal.signal(number, handler)


def test_a_command_that_ends_without_an_error_is_done(run):
    assert run(None) == (DONE, "")


def test_an_error_of_the_input_is_one_line(run):
    assert run(InputError("a.stl:\n  expected a file")) == (WRONG, "amprep: a.stl: expected a file\n")


def test_memory_that_runs_out_gives_advice(run):
    code, text = run(MemoryError())
    assert code == WRONG
    assert "use a coarser pitch" in text


def test_an_error_of_the_program_says_how_to_report_it(run):
    code, text = run(ZeroDivisionError("division by zero"))
    assert code == WRONG
    assert text.startswith(
        "amprep: internal error, ZeroDivisionError: division by zero; run again with --debug"
    )
    assert text.count("\n") == 1


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_before_files_appear_ends_with_its_own_code(run, monkeypatch, number, code, capsys):
    def end(code):
        raise SystemExit(code)

    monkeypatch.setattr("os._exit", end)

    monkeypatch.setattr(amprep.cli.app, "app", lambda: signal.raise_signal(number))
    monkeypatch.setattr("sys.argv", ["amprep"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == code
    assert capsys.readouterr().err == "amprep: interrupted; nothing was written\n"


def test_a_signal_when_files_appear_ends_with_the_code_of_the_run(run, monkeypatch, capsys):
    def app():
        with interruption.held():
            signal.raise_signal(signal.SIGTERM)
            interruption.files_appeared()
        sys.exit(INCOMPLETE)

    monkeypatch.setattr(amprep.cli.app, "app", app)
    monkeypatch.setattr("sys.argv", ["amprep"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == INCOMPLETE
    assert (
        capsys.readouterr().err == "amprep: SIGTERM came when the files appeared; all of them are complete\n"
    )


@pytest.mark.parametrize("error", [InputError("wrong"), MemoryError(), ZeroDivisionError()])
def test_with_debug_the_error_is_not_caught(monkeypatch, error):
    def app():
        raise error

    monkeypatch.setattr(amprep.cli.app, "app", app)
    monkeypatch.setattr("sys.argv", ["amprep", "--debug"])
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    with pytest.raises(type(error)):
        main()


_COUNTING = """
import resource, sys
from amprep.cli import _keep_freed_memory
if sys.argv[1:]:
    _keep_freed_memory()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(4):
    bytes(1) * (40 << 20)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other C libraries have no such settings")
def test_freed_memory_is_used_again():
    def faults(*arguments):
        command = [sys.executable, "-c", _COUNTING, *arguments]
        return int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    assert faults("keep") < 0.5 * faults()


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="signals of POSIX")
@pytest.mark.parametrize("how", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_that_comes_while_the_command_starts_ends_it_in_one_line(how):
    code = (
        "import signal, sys\nimport amprep.cli as cli\nsys.argv = ['amprep', 'printers', 'list']\n"
        f"cli._keep_freed_memory = lambda: signal.raise_signal(signal.{how})\n"
        "from amprep import interruption\nwatch = interruption.watch\n"
        "interruption.watch = lambda _: watch()\ncli.main()\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert ended.returncode == 128 + getattr(signal, how)
    assert ended.stderr == "amprep: interrupted; nothing was written\n"
