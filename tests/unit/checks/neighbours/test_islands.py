"""Every component of a support touches a part that it holds, or is named."""

import pytest
from tests.shared.supported import box, build_of, table

from amprep.checks.neighbours.islands import PROMISE, check_islands
from amprep.model import Stop


def post():
    return box((4, 4, 10.1), (2, 2, 0))


def found(support):
    return check_islands(build_of([table(10)], [support]), Stop())


def test_a_support_in_one_piece_below_its_part_is_no_fault():
    assert found(post()) == []


def test_a_piece_that_ends_below_the_part_is_named_with_its_place():
    (violation,) = found(post() + box((3, 3, 8), (12, 12, 0)))
    assert (violation.promise, violation.subject) == (PROMISE, "support-0")
    assert "1 component without contact to part-0" in violation.message


@pytest.mark.parametrize("second", [((3, 3, 10.1), (12, 12, 0)), ((3, 3, 8), (5, 5, 0))])
def test_pieces_that_reach_the_part_themselves_or_through_another_are_no_fault(second):
    assert found(post() + box(*second)) == []


def test_a_sliver_of_a_boolean_and_a_void_are_no_pieces():
    assert found(post() + box((0.04, 0.04, 0.04), (15, 15, 1))) == []
    assert found(post() - box((2, 2, 2), (3, 3, 3))) == []
