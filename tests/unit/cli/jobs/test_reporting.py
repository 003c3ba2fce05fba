"""What commands on jobs do before and after they call the public API."""

from typer.testing import CliRunner

from amprep import interruption
from amprep.cli.app import app
from amprep.errors import JobError
from amprep.host import Host


def test_before_files_are_made_a_signal_may_end_the_run_at_once(monkeypatch, tmp_path):
    """An exception that a signal raises while a library calls back into Python is printed and ignored."""
    seen = []

    def load(**_):
        seen.append(interruption._STATE.clean)
        raise JobError("far enough")

    monkeypatch.setattr(Host, "load", load)
    monkeypatch.setattr(interruption._STATE, "clean", None)
    result = CliRunner().invoke(app, ["run", str(tmp_path / "a.stl")])
    assert str(result.exception) == "far enough"
    assert callable(seen[0])
