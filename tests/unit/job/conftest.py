"""Fixtures of the tests of jobs."""

import pytest


@pytest.fixture
def job_file(tmp_path):
    """Write a job file called bracket.toml and return its path."""

    def write(text, inputs='inputs = ["a.stl"]\n'):
        path = tmp_path / "bracket.toml"
        path.write_text(inputs + text, encoding="utf-8")
        return path

    return write
