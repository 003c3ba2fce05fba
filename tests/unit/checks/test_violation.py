"""Places in messages have one form, which reports read back."""

import numpy as np

from amprep.checks.violation import Violation, place_words


def test_a_place_is_written_in_round_brackets_without_needless_digits():
    assert place_words(np.array([12.504, -3.0, 0.0])) == "(12.5, -3, 0)"
    assert place_words(np.array([-0.001, 0.0004, 1234.567]), 3) == "(-0.001, 0, 1234.567)"


def test_a_violation_in_one_line_has_promise_subject_and_message():
    assert str(Violation("legs", "bar", "too long")) == "legs: bar: too long"
