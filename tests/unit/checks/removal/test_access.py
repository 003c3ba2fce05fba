"""A contact is reached by a straight line from outside, or named."""

import pytest
from tests.shared.supported import box, build_of, table

from amprep.checks.removal.access import check_access, hidden_contacts
from amprep.model import Stop


def judged(part, support):
    build = build_of([part], [support])
    return build, hidden_contacts(build, build.supports[0])


def test_a_contact_below_a_plate_in_the_open_is_reached():
    build, (hidden, number) = judged(table(10), box((5, 5, 10.05), (8, 8, 0)))
    assert number > 0
    assert len(hidden) == 0
    assert check_access(build, Stop()) == []


def test_a_support_in_a_closed_hollow_is_hidden():
    hollow = box((20, 20, 20), (0, 0, 0)) - box((10, 10, 10), (5, 5, 5))
    build, (hidden, number) = judged(hollow, box((2, 2, 10.1), (9, 9, 4.95)))
    assert len(hidden) == number > 0
    (found,) = check_access(build, Stop())
    assert found.promise == "contacts can be reached"
    assert "straight tool" in found.message


@pytest.mark.parametrize("is_bent", [False, True])
def test_a_straight_channel_lets_a_tool_in_and_a_bent_one_does_not(is_bent):
    block = box((60, 20, 40), (0, 0, 0)) - box((10, 10, 10), (5, 5, 5))
    straight = box((60, 10, 10), (12, 5, 5))
    bent = box((18, 10, 10), (12, 5, 5)) + box((6, 10, 30), (24, 5, 5)) + box((60, 10, 6), (24, 5, 29))
    support = box((2, 2, 10.1), (6, 9, 4.95))
    _, (found, number) = judged(block - (bent if is_bent else straight), support)
    assert number > 0
    assert bool(len(found)) == is_bent
