"""Supports that differ from what their file recorded are named, and what was judged is said."""

from dataclasses import replace

import pytest
from tests.shared.supported import box, build_of, table

from amprep.checks.printed.unchanged import PROMISE, RECORD, check_unchanged, extent_of, extent_of_record
from amprep.model.build import StoredRecord, StoredSupport

BUILD = build_of([table(10)], [box((4, 4, 10.1), (2, 2, 0))])


def stored(recorded="a", found="a", moved=0.0):
    support = replace(BUILD.supports[0], stored=StoredSupport(recorded, found, moved))
    return replace(BUILD, supports=(support,))


def test_a_support_as_it_was_written_is_no_fault():
    assert check_unchanged(stored()) == []
    assert check_unchanged(stored(moved=1e-3)) == []
    assert extent_of(stored(), "not judged") == "SHA-256 of 1 support"


def test_another_geometry_is_named():
    (found,) = check_unchanged(stored(found="b"))
    assert (found.promise, found.subject) == (PROMISE, "support-0")
    assert "differs from what the build file recorded" in found.message


@pytest.mark.parametrize("moved", [2e-3, float("inf"), float("nan")])
def test_another_place_is_named(moved):
    (found,) = check_unchanged(stored(moved=moved))
    assert found.message == f"it is {moved:.4g} mm from where it was written"


def test_what_has_no_digest_is_said_not_to_be_judged():
    old = stored(recorded="")
    assert check_unchanged(old) == []
    assert extent_of(old, "not judged").startswith("not judged: an earlier version wrote the file")
    assert check_unchanged(BUILD) == []
    assert extent_of(BUILD, "not judged") == "not judged: the build is in no file"


def test_a_changed_record_is_named():
    changed = replace(BUILD, stored=StoredRecord("a", "b"))
    (found,) = check_unchanged(changed)
    assert (found.promise, found.subject) == (RECORD, BUILD.settings.build_id)
    assert extent_of_record(changed, "not judged").startswith("SHA-256 of the record")


def test_a_record_as_it_was_written_or_without_a_digest_is_no_fault():
    assert check_unchanged(replace(BUILD, stored=StoredRecord("a", "a"))) == []
    old = replace(BUILD, stored=StoredRecord("", "a"))
    assert check_unchanged(old) == []
    assert extent_of_record(old, "not judged").startswith("not judged: an earlier version wrote the file")
    assert extent_of_record(BUILD, "not judged") == "not judged: the build is in no file"
