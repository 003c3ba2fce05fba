"""JSON of a build record survives XML, and every value of another type or range is refused by its name."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.threemf.build import values
from amprep.threemf.package.xml import parse_xml


@given(st.recursive(st.none() | st.booleans() | st.integers() | st.text(), st.lists))
def test_any_json_is_read_back_from_xml(value):
    text = values.to_json(value)
    root = parse_xml(f"<record>{text}</record>".encode())
    assert values.from_json(root.text or "") == json.loads(json.dumps(value))


def test_characters_that_xml_forbids_are_replaced():
    assert values.xml_text("a\x00b\x1fc\td") == "a\ufffdb\ufffdc\td"
    assert values.xml_text("\ud800 \uffff \U0001f600") == "\ufffd \ufffd \U0001f600"


def test_json_that_is_nested_too_deeply_is_an_error_of_its_value():
    with pytest.raises(ValueError, match="nested too deeply"):
        values.from_json("[" * 100_000)
    with pytest.raises(ValueError, match="Expecting"):
        values.from_json("{")


def test_xml_that_is_not_well_formed_is_an_error_of_its_value():
    with pytest.raises(ValueError, match="mismatch"):
        parse_xml(b"<a></b>")


def test_whole_numbers_are_written_without_a_point():
    assert values.to_json(values.plain(np.array([[1.0, 0.25], [-3.0, 2.0**60]]))) == (
        f"[[1, 0.25], [-3, {2.0**60}]]"
    )
    assert values.plain(np.array([0.123456, 2.0000001]), 3) == [0.123, 2]


RECORD = {
    "length": 1.5,
    "count": 3,
    "indices": [0, 2],
    "name": "bracket",
    "fixed": True,
    "kind": "box",
    "rows": [[1, 2], [3, 4]],
    "row": [1, 2],
    "none": [],
}


def test_values_of_the_right_type_are_returned():
    assert values.number(RECORD, "length") == 1.5
    assert values.integer(RECORD, "count") == 3
    assert values.integers(RECORD, "indices", below=3) == (0, 2)
    assert values.string(RECORD, "name") == "bracket"
    assert values.boolean(RECORD, "fixed") is True
    assert values.choice(RECORD, "kind", ("box", "cylinder")) == "box"
    assert values.table(RECORD, "rows", 2).tolist() == [[1, 2], [3, 4]]
    assert values.table(RECORD, "row", 2).tolist() == [[1, 2]]
    assert values.table(RECORD, "none", 2).shape == (0, 2)
    assert values.as_object(RECORD, "record") is RECORD


@pytest.mark.parametrize(
    ("read", "wrong", "message"),
    [
        (values.number, [True, "1", None, [1]], "must be a finite number"),
        (values.integer, [True, -1, 2**31, 1.0, "1"], "must be an integer from 0 to"),
        (lambda record, name: values.integers(record, name, 3), [[3], [0, -1], [0.5]], "must be an integer"),
        (lambda record, name: values.integers(record, name, 3), [3, "012", {}], "must be a list"),
        (values.string, [1, None, ["a"]], "must be a string"),
        (values.boolean, [0, 1, "true", None], "must be true or false"),
        (lambda record, name: values.choice(record, name, ("a", "b")), ["c", ""], "must be one of a, b"),
        (lambda record, name: values.table(record, name, 2), [[[1, 2, 3]], [[1, 1e999]]], "rows of 2 finite"),
    ],
)
def test_other_values_are_refused_by_name(read, wrong, message):
    for value in wrong:
        with pytest.raises(ValueError, match=message) as caught:
            read({"field": value}, "field")
        assert "field" in str(caught.value)


def test_what_is_not_an_object_or_is_missing_is_refused():
    with pytest.raises(ValueError, match="settings must be an object"):
        values.as_object([1], "settings")
    with pytest.raises(ValueError, match="length"):
        values.number({}, "length")
