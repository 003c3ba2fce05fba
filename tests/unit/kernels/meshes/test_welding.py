"""Equal rows get equal numbers, in order of first appearance."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from amprep.geometry.meshes.welding import label_equal_rows

VALUES = st.integers(-2, 2) | st.sampled_from([2**62, -(2**62), 2**32, -(2**32) - 1])


@given(st.lists(st.tuples(VALUES, VALUES, VALUES), max_size=40))
def test_labels_are_those_of_a_dictionary(rows):
    known: dict[tuple[int, ...], int] = {}
    expected = [known.setdefault(row, len(known)) for row in rows]
    label, count = label_equal_rows(np.array(rows, np.int64).reshape(-1, 3))
    assert label.tolist() == expected
    assert count == len(known)
