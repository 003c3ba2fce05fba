"""Powder that cannot leave a support is named, in pockets and in cavities that are too narrow for a ball."""

from tests.shared.supported import box, build_of, table

from amprep.checks.removal.powder import PROMISE, check_powder
from amprep.model import Stop


def messages(hollow=None, corner=(1, 1, 1)):
    support = box((4, 4, 10.1), (2, 2, 0))
    support = support if hollow is None else support - box(hollow, (2 + corner[0], 2 + corner[1], corner[2]))
    found = check_powder(build_of([table(10)], [support]), Stop())
    assert {each.promise for each in found} <= {PROMISE}
    return [each.message for each in found]


def test_a_support_without_cavities_holds_no_powder():
    assert messages() == []


def test_a_pocket_is_named_once():
    (message,) = messages((2, 2, 2))
    assert "in 1 pocket" in message


def test_a_slit_too_narrow_for_the_ball_is_named_with_its_volume():
    (message,) = messages((2, 2, 0.15))
    assert message.startswith("0.6 mm3 of powder in 1 closed cavity too narrow for a ball of 0.2 mm")


def test_a_slit_that_is_open_and_a_void_smaller_than_a_grain_are_no_cavities():
    assert messages((2, 4, 0.15)) == []
    assert messages((0.04, 0.04, 0.04)) == []


def test_a_pocket_within_a_ring_shaped_slit_does_not_hide_it():
    ring = box((3.6, 3.6, 0.15), (2.2, 2.2, 4)) - box((2.4, 2.4, 1), (2.8, 2.8, 3.5))
    hollow = box((4, 4, 10.1), (2, 2, 0)) - ring - box((2, 2, 0.6), (3, 3, 3.8))
    pocket, cavity = check_powder(build_of([table(10)], [hollow]), Stop())
    assert "in 1 pocket" in pocket.message
    assert cavity.message.startswith("1.08 mm3 of powder in 1 closed cavity")
