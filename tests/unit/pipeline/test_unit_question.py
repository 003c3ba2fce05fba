"""A part of an implausible size gets a question about its unit; other parts get none."""

import pytest
import trimesh

import amprep
from amprep.errors import AmprepError, JobError


def loaded(tmp_path, size, **settings):
    trimesh.creation.box((size, size / 2, size / 4)).export(tmp_path / "bracket.stl")
    (part,) = amprep.load(tmp_path / "bracket.stl", settings=settings).parts
    return part


@pytest.mark.parametrize("size", [0.05, 2600.0])
def test_sizes_that_a_printer_makes_raise_no_question(tmp_path, size):
    assert loaded(tmp_path, size, **{"supports.layer_mm": 0.04}).warnings == ()


def test_a_part_smaller_than_a_layer_may_be_in_inches_or_metres(tmp_path):
    (warning,) = loaded(tmp_path, 0.03, **{"supports.layer_mm": 0.04}).warnings
    assert warning == "it is 0.03 mm long; is its unit the inch or the metre? use --unit"


def test_a_part_ten_times_longer_than_the_printer_may_be_in_micrometres(tmp_path):
    (warning,) = loaded(tmp_path, 4000.0).warnings
    assert warning == "it is 4e+03 mm long; is its unit the micron, or was it converted twice? use --unit"


@pytest.mark.parametrize("factor", [25.4, 1000.0])
def test_the_question_stands_in_the_error_where_nothing_fits(tmp_path, factor):
    trimesh.creation.box((200 * factor, 20 * factor, 20)).export(tmp_path / "bracket.stl")
    with pytest.raises(
        AmprepError, match=r"too large: bracket\); bracket: it is .* is its unit .* use --unit"
    ):
        amprep.pack(amprep.load(tmp_path / "bracket.stl"))


@pytest.mark.parametrize(("unit", "factor"), [("micron", 1e-3), ("inch", 25.4), ("metre", 1000.0)])
def test_the_unit_of_the_job_scales_files_that_state_none(tmp_path, unit, factor):
    part = loaded(tmp_path, 8.0, **{"reading.unit": unit})
    assert part.volume_mm3 == pytest.approx(8 * 4 * 2 * factor**3, rel=1e-5)


def test_an_unknown_unit_is_refused_with_the_known_ones(tmp_path):
    with pytest.raises(
        JobError, match="unit must be one of micron, millimetre, centimetre, inch, foot, metre"
    ):
        loaded(tmp_path, 8.0, **{"reading.unit": "yard"})
