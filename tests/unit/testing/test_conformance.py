"""`plugins new`, `plugins check` and `plugins list`: a new plugin passes its own tests as it is."""

import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from amprep.cli.catalogues.plugins import app
from amprep.errors import PluginError
from amprep.host import KINDS, Host, scaffold
from amprep.host.scaffold import make_plugin
from amprep.testing import LoadedOffer, try_offer, try_plugin


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_new_plugin_is_a_package_whose_offer_keeps_every_promise(tmp_path, kind):
    folder = make_plugin(f"amprep-fresh-{kind}", kind, tmp_path)
    module = folder / "src" / f"amprep_fresh_{kind}"
    samples = sorted((folder / "tests").glob("sample.*"))
    (trial,) = try_plugin(str(module), samples=samples)
    assert (trial.kind, trial.name, trial.violations) == (kind, f"fresh-{kind}", ())
    assert trial.problems


@pytest.mark.parametrize("kind", ["packer", "reader"])
def test_the_tests_of_a_new_plugin_pass_as_they_are(tmp_path, kind):
    folder = make_plugin("rows", kind, tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 passed" in done.stdout


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_new_plugin_says_where_it_is_found_and_how_it_is_chosen(tmp_path, kind):
    import tomllib

    folder = make_plugin("amprep-fresh", kind, tmp_path)
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
    assert project["project"]["entry-points"]["amprep"] == {"fresh": "amprep_fresh"}
    assert '"fresh"' in (folder / "README.md").read_text(encoding="utf-8")
    assert not [
        path for path in folder.rglob("*") if path.is_file() and "${" in path.read_text(encoding="utf-8")
    ]


@pytest.mark.parametrize("name", ["", "Shelves", "a b", "../x", "-x", "x-", "a--b", "1x", "x" * 61])
def test_a_name_that_is_no_package_name_is_refused(tmp_path, name):
    with pytest.raises(PluginError, match="lower-case words with dashes"):
        make_plugin(name, "packer", tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["amprep", "json", "class"])
def test_a_name_that_python_or_amprep_uses_is_refused(tmp_path, name):
    with pytest.raises(PluginError, match="is taken by Python or amprep"):
        make_plugin(name, "packer", tmp_path)


def test_nothing_is_overwritten_and_an_unknown_kind_is_refused(tmp_path):
    make_plugin("rows", "packer", tmp_path)
    with pytest.raises(PluginError, match="exists already"):
        make_plugin("rows", "cell", tmp_path)
    with pytest.raises(PluginError, match=r"no kind of offer is called 'pakcer' \(did you mean 'packer'\?\)"):
        make_plugin("other", "pakcer", tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(PluginError, match="cannot be made"):
        make_plugin("other", "packer", tmp_path / "file")


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_plugin_appears_with_all_files_or_not_at_all(tmp_path, monkeypatch, failure):
    save, saved = scaffold._save, []

    def fail_at_the_third(path, text):
        saved.append(path)
        if len(saved) == 3:
            raise failure
        save(path, text)

    monkeypatch.setattr(scaffold, "_save", fail_at_the_third)
    with pytest.raises((PluginError, KeyboardInterrupt)):
        make_plugin("rows", "packer", tmp_path)
    assert not list(tmp_path.iterdir())


BROKEN = """
import numpy as np
from amprep.hookspecs import Packer, hookimpl
from amprep.model import Packing, Placement
amprep_api = 1

def piled(problem, *, params, rng, stop, progress):
    return Packing((tuple(Placement(i, np.eye(3), np.zeros(3)) for i in range(len(problem.items))),))

def moody(problem, *, params, rng, stop, progress):
    raise ValueError("not today")

@hookimpl
def amprep_packers():
    yield Packer("piled", "all at one place", run=piled)
    yield Packer("moody", "never", run=moody)
"""


def test_a_packer_that_breaks_its_promises_is_found_out(tmp_path):
    path = tmp_path / "broken_packers.py"
    path.write_text(BROKEN)
    piled, moody = try_plugin(str(path))
    assert not piled.passed
    assert {violation.promise for violation in moody.violations} == {"runs"}
    assert (
        "packer 'moody' of module broken_packers failed: ValueError: not today" in moody.violations[0].message
    )


def test_a_reader_that_no_valid_file_has_tried_is_reported_as_such(tmp_path):
    folder = make_plugin("my-reader", "reader", tmp_path)
    (report,) = try_plugin(str(folder / "src" / "my_reader"))
    assert report.notes == ("no valid file was read; name one with --sample FILE",)
    (report,) = try_plugin(
        str(folder / "src" / "my_reader"), samples=sorted((folder / "tests").glob("sample.*"))
    )
    assert report.notes == ()


def test_check_refuses_a_name_that_is_taken(tmp_path):
    path = tmp_path / "own_box.py"
    path.write_text(BROKEN.replace('"piled"', '"extreme-points"'))
    with pytest.raises(PluginError, match=r"'extreme-points' is offered by amprep .* and by module own_box"):
        try_plugin(str(path))


def test_the_commands_list_check_and_new(tmp_path):
    run = CliRunner().invoke
    made = run(app, ["new", "amprep-rows", "-o", str(tmp_path)])
    assert made.exit_code == 0, made.output
    module = str(tmp_path / "amprep-rows" / "src" / "amprep_rows")
    assert run(app, ["check", module]).exit_code == 0
    (trial,) = json.loads(run(app, ["check", module, "--json"]).output)
    assert (trial["kind"], trial["name"], trial["violations"]) == ("packer", "rows", [])
    broken = tmp_path / "broken.py"
    broken.write_text(BROKEN)
    assert run(app, ["check", str(broken)]).exit_code == 1
    listing = json.loads(run(app, ["list", "--json", "-p", module]).output)
    row = next(offer for offer in listing["offers"] if offer["name"] == "rows")
    assert (row["kind"], row["plugin"], row["builtin"], listing["api"]) == ("packer", "amprep_rows", False, 1)
    assert row["accepts"]["objectives"] == ["builds"]
    assert "extreme-points" in run(app, ["list"]).output


BUILT_IN = Host.load(plugins_enabled=False)


@pytest.mark.parametrize(
    "listed",
    [each for kind in KINDS for each in BUILT_IN.offers(kind).values()],
    ids=lambda listed: f"{listed.kind}-{listed.offer.name}",
)
def test_a_built_in_offer_keeps_every_promise_on_the_trial_problems(listed):
    trial = try_offer(LoadedOffer.of(BUILT_IN, listed, {}))
    assert trial.problems
    assert trial.violations == ()
