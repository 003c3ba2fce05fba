"""Settings of the user fill in what a job does not state, and nothing else."""

import pytest

from amprep.errors import JobError
from amprep.job import job_from_inputs, override
from amprep.job.user_settings import with_user_settings


@pytest.fixture
def settings(tmp_path):
    """Write the settings of a user and return the environment that leads to them."""

    def write(text):
        folder = tmp_path / "amprep"
        folder.mkdir()
        (folder / "settings.toml").write_text(text, encoding="utf-8")
        return {"XDG_CONFIG_HOME": str(tmp_path), "APPDATA": str(tmp_path), "HOME": str(tmp_path)}

    return write


def test_what_a_job_states_stays_and_the_rest_is_filled_in(settings):
    env = settings('printer = "Prusa MK4"\ntarget = "prusaslicer"\n')
    job, taken, file = with_user_settings(override(job_from_inputs(["a.stl"]), {"target": "cura"}), env)
    assert (job.printer.name, job.target) == ("Prusa MK4", "cura")
    assert taken == {"printer": "Prusa MK4"}
    assert file.name == "settings.toml"
    assert not job.printer_is_default


def test_without_the_file_a_job_stays_as_it_is(tmp_path):
    job = job_from_inputs(["a.stl"])
    found = with_user_settings(job, {"XDG_CONFIG_HOME": str(tmp_path), "APPDATA": str(tmp_path)})
    assert found.job is job
    assert found.taken == {}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('printr = "x"', "did you mean 'printer'"),
        ("seed = 3", "unknown key 'seed'"),
        ('printer = "Prusa MK44"', "did you mean"),
        ("printer = 3", "expected a text"),
        ("printer =", "not a TOML file"),
    ],
)
def test_a_wrong_file_is_named(settings, text, reason):
    with pytest.raises(JobError, match=reason) as caught:
        with_user_settings(job_from_inputs(["a.stl"]), settings(text))
    assert "settings.toml" in str(caught.value)
