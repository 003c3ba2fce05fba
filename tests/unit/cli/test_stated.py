"""Options with wrong values are named as the user wrote them, not by the keys of job files."""

import pytest

from amprep.cli.options import BuildOptions
from amprep.cli.stated import OPTIONS, stated_job
from amprep.errors import JobError


@pytest.mark.parametrize(
    ("key", "value", "option"),
    [
        ("target", "prusa", "--for"),
        ("cells.connector", "tooth", "--connector"),
        ("reading.unit", "mile", "--unit"),
        ("seed", -3, "--seed"),
        ("printer", "no such printer", "--printer"),
    ],
)
def test_a_wrong_value_names_its_option(key, value, option):
    with pytest.raises(JobError, match=rf"^{option}[: ]"):
        stated_job(["part.stl"], {"material": None, key: value}, [])


def test_a_wrong_value_of_a_job_file_or_of_set_names_its_key(tmp_path):
    (tmp_path / "job.toml").write_text('inputs = ["part.stl"]\ntarget = "prusa"\n')
    with pytest.raises(JobError, match=r"job.toml: target: expected"):
        stated_job([str(tmp_path / "job.toml")], {"cells.base": "raft"}, [])
    with pytest.raises(JobError, match=r"with --set: target: expected"):
        stated_job(["part.stl"], {"cells.base": "raft"}, ["target=prusa"])


def test_every_setting_that_an_option_changes_has_its_option():
    assert set(BuildOptions().changes) <= set(OPTIONS)
