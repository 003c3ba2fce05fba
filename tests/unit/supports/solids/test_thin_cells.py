"""The pitch of the grid suits the cell, and walls that are thinner than the least wall are warned of."""

import re

import pytest

from amprep.host import Host
from amprep.job import override
from amprep.job.loading import make_job
from amprep.pipeline.resolve import resolve
from amprep.supports.solids.thin_cells import suitable_pitch, wall_advice


def resolved(cell, params, **supports):
    table = {"supports": supports, "cells": {"strategy": cell, "params": params}}
    job = make_job({"inputs": ["a.stl"], **table}, name="job", folder=None, source="job")
    return resolve(job, Host.load())


def pitch_for(chosen, pitch=0.8):
    return suitable_pitch(chosen.cell.emit, pitch, chosen.job.supports)


def advice(chosen, pitch):
    return list(wall_advice(chosen.job.cells.strategy, chosen.cell.emit, pitch, chosen.job.supports))


@pytest.mark.parametrize(
    ("cell", "params", "pitch", "remedy"),
    [("x-wall", {}, 0.7, "pitch_mm=0.8$"), ("x-wall", {}, 0.8, ""), ("prism", {}, 0.7, "")]
    + [
        ("x-wall", {"wall_mm": 0.2}, 2.0, "thicker walls$"),
        ("strut", {"diameter_mm": 0.2}, 2.0, "thicker walls$"),
        ("strut", {}, 0.8, ""),
        ("x-wall", {"wall_mm": 0.3, "gap_mm": 0.1}, 0.7, ""),
    ],
)
def test_a_pitch_that_makes_walls_thinner_than_the_least_wall_is_warned_of(cell, params, pitch, remedy):
    chosen = resolved(cell, params, pitch_mm=pitch)
    sentences = advice(chosen, pitch)
    assert len(sentences) == bool(remedy)
    words = f"{cell} are thinner than the least wall of 0.3 mm .*{remedy}"
    assert all(re.search(words, each) for each in sentences)
    without = override(chosen.job, {"supports.least_wall_mm": 0.0})
    assert not advice(resolve(without, Host.load()), pitch)


@pytest.mark.parametrize("cell", ["x-wall", "strut", "bcc", "hatch", "prism"])
def test_default_sizes_suit_the_finest_automatic_pitch(cell):
    assert pitch_for(resolved(cell, {})) == 0.8


def test_the_pitch_is_raised_until_the_cell_fits():
    thick = resolved("x-wall", {"wall_mm": 0.4})
    pitch = pitch_for(thick)
    assert pitch > 0.8
    assert not advice(thick, pitch)
    assert pitch_for(resolved("strut", {"diameter_mm": 0.2})) == 0.8, "no pitch would help"
