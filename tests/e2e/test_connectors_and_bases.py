"""Jobs with teeth or points on flanges or rafts, from the command line."""

import pytest


@pytest.mark.parametrize(
    "options",
    [
        ("--connector", "teeth", "--base", "raft", "--set", "cells.neck_mm=0.3"),
        ("--connector", "point", "--base", "flange", "--set", "cells.perforation_mm=0.5"),
    ],
)
def test_a_job_with_teeth_or_points_on_a_base_verifies(amprep, fixtures, tmp_path, options):
    plain = ("--cell", "prism", "--set", "supports.pitch_mm=4", "--set", "supports.reach_mm=5")
    done = amprep("run", fixtures / "table.stl", *options, *plain, "-o", tmp_path)
    assert done.code == 0, done.err
    assert amprep("verify", tmp_path / "table.build-1.3mf").code == 0


def test_the_kinds_that_do_not_exist_are_refused_with_those_that_do(amprep, fixtures, tmp_path):
    for option, words in (("--connector", "'full', 'teeth', 'point', 'extend'"), ("--base", "'raft'")):
        done = amprep("support", fixtures / "table.stl", option, "spikes", "-o", tmp_path)
        assert (done.code, words in done.err) == (2, True), done.err
        assert len(done.err.strip().splitlines()) <= 3
