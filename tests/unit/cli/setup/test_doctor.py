"""`amprep doctor` says what is installed, in words and as JSON."""

import json
from importlib.metadata import PackageNotFoundError

import numba
from typer.testing import CliRunner

from amprep import __version__
from amprep.cli.app import app
from amprep.cli.setup import doctor


def test_packages_slicers_plugins_profiles_and_kernels_are_named(monkeypatch, tmp_path):
    slicer = tmp_path / "prusa-slicer"
    slicer.write_text("#!/bin/sh\necho PrusaSlicer-2.5.0 based on Slic3r\n", encoding="utf-8")
    slicer.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    found = json.loads(CliRunner().invoke(app, ["doctor", "--json"]).stdout)
    assert found["amprep"]["version"] == __version__
    assert found["packages"]["numba"] == numba.__version__
    assert "pytest" not in found["packages"]
    assert found["slicers"]["PrusaSlicer"] == f"2.5.0 ({slicer})"
    assert "packers annealing, auto, " in found["plugins"]["built-in"]
    assert "support routers auto, " in found["plugins"]["built-in"]
    assert found["profiles"]["printers"].endswith("printers)")
    done, _, total = found["numeric code"]["compiled functions"].partition(";")[0].partition(" of ")
    assert 0 <= int(done) <= int(total)
    assert int(total) > 100
    assert f"version: {__version__}" in CliRunner().invoke(app, ["doctor"]).stdout


def test_without_an_installation_no_packages_are_listed(monkeypatch):
    def missing(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(doctor, "requires", missing)
    assert json.loads(CliRunner().invoke(app, ["doctor", "--json"]).stdout)["packages"] == {}
