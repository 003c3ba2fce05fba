"""Conversion of plain values to typed ones."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.errors import JobError
from amprep.typed import convert, expectation, field_types, make


@dataclass(frozen=True)
class Sample:
    count: int = 1
    ratio: float = 0.5
    word: Literal["one", "two"] = "one"
    sizes: tuple[float, ...] = ()
    pair: tuple[int, str] | None = None
    path: Path = Path()
    table: Mapping[str, Any] | None = None


@given(st.integers())
def test_a_whole_number_is_accepted_where_a_number_is_expected(value):
    assert convert(value, int, "x") == value
    if abs(value) <= 1e300:
        assert convert(value, float, "x") == float(value)


@pytest.mark.parametrize("value", [True, 1.0, "1", None])
def test_only_whole_numbers_are_integers(value):
    with pytest.raises(JobError, match="expected a whole number"):
        convert(value, int, "x")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, "0.5"])
def test_a_number_is_finite_and_not_a_truth_value(value):
    with pytest.raises(JobError, match="expected a number"):
        convert(value, float, "x")


def test_a_table_becomes_a_record_of_the_right_types():
    made = make(
        Sample, {"ratio": 1, "sizes": [1, 2.5], "pair": [3, "a"], "path": "b.stl", "table": {"k": 1}}, "t"
    )
    assert made == Sample(ratio=1.0, sizes=(1.0, 2.5), pair=(3, "a"), path=Path("b.stl"), table={"k": 1})
    assert [type(size) for size in made.sizes] == [float, float]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"word": "three"}, r"t: word: expected one of 'one', 'two', got the text 'three'"),
        ({"sizes": [1, "x"]}, r"t: sizes: expected a list, each a number, got the list \[1, 'x'\]"),
        ({"pair": [1]}, "t: pair: expected a list of a whole number, a text, got the list"),
        ({"cuont": 1}, r"t: unknown key 'cuont' \(did you mean 'count'\?\)"),
    ],
)
def test_a_wrong_value_is_refused_with_what_was_expected_and_what_came(table, message):
    with pytest.raises(JobError, match=message):
        make(Sample, table, "t")


def test_a_type_that_no_plain_value_has_is_a_programming_error():
    with pytest.raises(TypeError, match="use bool, int, float"):
        expectation(complex, "x")
    assert set(field_types(Sample)) == {"count", "ratio", "word", "sizes", "pair", "path", "table"}
