"""Numbers of things have the right form of the noun."""

import pytest

from amprep.model.counting import counted


@pytest.mark.parametrize(
    ("number", "words"),
    [(0, ("0 parts", "0 boxes")), (1, ("1 part", "1 box")), (2, ("2 parts", "2 boxes"))],
)
def test_only_one_thing_is_singular(number, words):
    assert (counted(number, "part"), counted(number, "box", "boxes")) == words
