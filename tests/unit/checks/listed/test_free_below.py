"""A build must not list a region as enclosed when nothing is between it and the plate."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.supported import box, build_of, table

from amprep.checks.listed.free_below import check_listed, extent_of
from amprep.model import BuildVolume, Unsupported
from amprep.model.supports.sizes import SupportSizes

SIZES = SupportSizes(square_mm=1.0)


def listed(at, reason="enclosed", radius=1.0, minor=False):
    return Unsupported(0, "overhang 1 of part-0", "face", reason, 4.0, np.array([at], float), radius, minor)


def build_with(region, *parts, bodies=()):
    build = build_of([table(20, corner=(30, 30)), *parts], bodies, SIZES)
    return replace(build, unsupported=(region,))


MIDDLE = (40.0, 40.0, 20.0)


@pytest.mark.parametrize("reason", ["enclosed", "territory"])
def test_a_region_with_a_free_column_below_is_no_reason(reason):
    (found,) = check_listed(build_with(listed(MIDDLE, reason)))
    assert found.promise == "listed overhangs"
    assert "free down to the plate" in found.message
    assert "(40, 40, 20) mm" in found.message


@pytest.mark.parametrize("reason", ["capacity", "time limit", "slender", "rule", "connector blocked"])
def test_reasons_that_a_free_column_does_not_refute_are_not_judged(reason):
    assert check_listed(build_with(listed(MIDDLE, reason))) == []


@pytest.mark.parametrize(
    "between",
    [
        box((20, 20, 2), (30, 30, 5)),  # a part below
        box((1, 1, 2), (41.5, 40, 5)),  # beside, within two squares
        box((1, 1, 0.5), (40, 40, 18)),  # just below
    ],
)
def test_anything_in_the_column_is_a_reason(between):
    assert check_listed(build_with(listed(MIDDLE), between)) == []


def test_another_support_in_the_column_is_a_reason():
    assert check_listed(build_with(listed(MIDDLE), bodies=[box((1, 1, 18), (40, 40, 0))])) == []


def test_what_is_farther_than_two_squares_or_above_is_none():
    beside, above = box((1, 10, 10), (43, 35, 0)), box((5, 5, 5), (38, 38, 30))
    assert len(check_listed(build_with(listed(MIDDLE), beside, above))) == 1


def test_columns_at_the_border_of_the_build_volume_and_in_zones_are_not_judged():
    build = build_with(listed(MIDDLE))
    small = replace(build, settings=replace(build.settings, space=BuildVolume([41, 200, 200])))
    assert check_listed(small) == []
    zone = BuildVolume([200, 200, 200], zone_lo=np.array([[39, 39, 0]]), zone_hi=np.array([[41, 41, 3]]))
    assert check_listed(replace(build, settings=replace(build.settings, space=zone))) == []


def test_a_region_cannot_be_listed_beyond_the_reach():
    build = build_with(listed(MIDDLE, "capacity", radius=3.1))
    (found,) = check_listed(build)
    assert "expected 3 mm" in found.message
    assert check_listed(build_with(listed(MIDDLE, "capacity", radius=3.0))) == []


@pytest.mark.parametrize("square", [0.0, 1e-9, 1000.0])
def test_no_size_of_squares_that_a_file_states_makes_the_judge_blind_or_slow(square):
    build = build_with(listed((40.0, 40.0, 20.0)))
    settings = replace(build.settings, sizes=replace(SIZES, square_mm=square))
    assert len(check_listed(replace(build, settings=settings))) == 1


def test_what_is_listed_is_told_with_its_reasons():
    build = build_with(listed(MIDDLE, "capacity"))
    assert extent_of(build, "not judged") == "1 region of 4 mm2 not supported (1 capacity)"
    minor = replace(build, unsupported=(*build.unsupported, listed(MIDDLE, "rule", minor=True)))
    assert extent_of(minor, "not judged").endswith("(1 capacity), 1 minor or excepted")
    assert extent_of(replace(build, unsupported=()), "not judged") == "not judged: none is listed"
