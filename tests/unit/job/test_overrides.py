"""Options of the command line change one key of a job and keep the others."""

import pytest

from amprep.errors import JobError
from amprep.job import apply_sets, load_job, override


@pytest.mark.parametrize(
    ("text", "section", "key", "value"),
    [
        ("supports.pitch_mm=0.8", "supports", "pitch_mm", 0.8),
        ("supports.enabled = false", "supports", "enabled", False),
        ("cells.strategy=prism", "cells", "strategy", "prism"),
        ('cells.strategy="prism"', "cells", "strategy", "prism"),
        ("cells.strategy=x wall", "cells", "strategy", "x wall"),
        ("packing.params={effort = 2}", "packing", "params", {"effort": 2}),
        ("packing.params.effort=2", "packing", "params", {"kept": 1, "effort": 2}),
    ],
)
def test_set_changes_one_key_and_keeps_the_others(job_file, text, section, key, value):
    job = load_job(job_file("[packing]\nclearance_mm = 3\nparams.kept = 1"))
    changed = apply_sets(job, [text])
    found = getattr(getattr(changed, section), key)
    assert found == value or (key == "params" and set(value.items()) <= set(found.items()))
    assert changed.packing.clearance_mm == 3
    assert job.packing.params == {"kept": 1}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pitch", "--set: expected key=value"),
        ("=3", "--set: expected key=value"),
        ("a=1\nb=2", "--set: expected key=value"),
        ("supports.pitch_mm=0,8", "expected a number, got the text '0,8'"),
        ("supports.pitch_mm=[1", "expected a TOML value"),
        ("cells.strategy='prism", "expected a TOML value"),
        ("name=../x", "characters that names of files may have"),
        (
            "supports.pitchmm=1",
            r"with --set: \[supports\]: unknown key 'pitchmm' \(did you mean 'pitch_mm'\?\)",
        ),
        ("supports.enabled=True", "expected true or false, got the text 'True'"),
        ("part.name=2", "entries of a list cannot be set"),
        ("a..b=2", "expected a TOML value"),
    ],
)
def test_a_wrong_set_says_what_was_expected(job_file, text, message):
    with pytest.raises(JobError, match=message):
        apply_sets(load_job(job_file("[[part]]\nname = 'a'")), [text])


def test_defaults_follow_what_is_set_last(job_file):
    job = apply_sets(load_job(job_file("")), ["printer='HP MJF 4200'", "supports.overhang_angle_deg=30"])
    assert (job.packing.stacking, job.supports.enabled, job.supports.strut_angle_deg) == (True, False, 30)


def test_the_options_of_the_command_line_win(job_file):
    job = load_job(
        job_file("seed = 1\n[packing]\nparams = {effort = 3}\nclearance_mm = 1\n[cells]\nparams = {a = 1}")
    )
    changed = override(
        job,
        {
            "printer": "SLM 280 2.0",
            "packing.strategy": "rows",
            "supports.strategy": "own",
            "cells.strategy": "x-wall",
            "target": "cura",
            "seed": 9,
        },
    )
    assert (changed.printer.name, changed.target, changed.seed) == ("SLM 280 2.0", "cura", 9)
    assert (changed.packing.strategy, changed.supports.strategy, changed.cells.strategy) == (
        "rows",
        "own",
        "x-wall",
    )
    assert changed.packing.params == {}, "the job's parameters belong to the job's own packer"
    assert (changed.cells.params, changed.packing.clearance_mm) == ({"a": 1}, 1)
    assert override(job, {"packing.strategy": None}) is job
    assert override(job, {"packing.params": {"b": 2}}).packing.params == {"b": 2}
    with pytest.raises(JobError, match="target: expected one of"):
        override(job, {"target": "bambu"})
    with pytest.raises(JobError, match="no printer is called"):
        override(job, {"printer": "EOS"})


def test_a_path_on_the_command_line_starts_at_the_current_folder(job_file, tmp_path, monkeypatch):
    here = tmp_path / "elsewhere"
    here.mkdir()
    (here / "mine.toml").write_text("size_mm = [10, 20, 30]")
    (here / "cell.stl").touch()
    monkeypatch.chdir(here)
    job = override(load_job(job_file("")), {"printer": "mine.toml", "cells.strategy": "cell.stl"})
    assert job.printer.space.size.tolist() == [10, 20, 30]
    assert job.cells.file == (here / "cell.stl").resolve()
