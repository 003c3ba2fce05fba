"""Bounds of settings, and TOML files within limits."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.errors import JobError
from amprep.validation import LARGEST_FILE, read_table, require, require_bounds


@dataclass(frozen=True)
class Sizes:
    width: float | None = 1.0
    height: float | None = 1.0


def test_a_broken_rule_is_named_with_the_value_and_the_advice():
    with pytest.raises(ValueError, match=r"^count must be odd, got 2; add one$"):
        require(False, "count must be odd", 2, "add one")


@pytest.mark.parametrize(
    ("bounds", "rule", "allowed", "refused"),
    [
        ({"at_least": 0}, "at least 0", 0, -1),
        ({"above": 0}, "above 0", 0.1, 0),
        ({"at_most": 5}, "at most 5", 5, 6),
        ({"below": 5}, "below 5", 4.9, 5),
        ({"at_least": 1, "at_most": 5}, "between 1 and 5", 5, 0),
        ({"above": 0, "at_most": 1}, "above 0 and at most 1", 1, 0),
        ({"at_least": 0}, "at least 0", None, float("nan")),
    ],
)
def test_a_value_on_the_right_side_of_a_bound_passes_and_one_on_the_wrong_side_is_refused(
    bounds, rule, allowed, refused
):
    require_bounds(Sizes(width=allowed), "width", **bounds)
    with pytest.raises(ValueError, match=f"^width must be {rule}, got {refused}$"):
        require_bounds(Sizes(width=refused), "width", **bounds)


@given(st.floats(allow_nan=True), st.floats(-10, 10), st.floats(-10, 10))
def test_bounds_agree_with_the_comparison_of_python(value, low, high):
    try:
        require_bounds(Sizes(width=value), "width", at_least=low, below=high)
        passed = True
    except ValueError:
        passed = False
    assert passed == (low <= value < high)


def test_every_named_field_is_checked():
    with pytest.raises(ValueError, match="height"):
        require_bounds(Sizes(1.0, -1.0), "width", "height", at_least=0)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "found nothing"),
        (b"\xff", "not a TOML file"),
        (b"a = ", "not a TOML file"),
        (b"a = " + b"[" * 3000 + b"]" * 3000, "nested too deeply"),
        (b" " * (LARGEST_FILE + 1), f"at most {LARGEST_FILE >> 20} MiB"),
    ],
)
def test_a_file_that_is_no_table_is_refused_with_its_name(tmp_path, content, message):
    path = tmp_path / "job.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(JobError, match=f"job.toml.*{message}"):
        read_table(path, "job")
