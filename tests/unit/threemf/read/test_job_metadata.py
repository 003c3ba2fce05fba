"""Metadata of a 3MF job give quantity, value and rotations; a value that cannot be is refused with its place."""

import numpy as np
import pytest

from amprep.errors import InputError
from amprep.threemf.names import NAMESPACE
from amprep.threemf.read.job_metadata import MOST_COPIES, JobMetadata, foreign_metadata, parse_job_metadata


def parsed(**settings):
    return parse_job_metadata(
        {(NAMESPACE, name): text for name, text in settings.items()}, "job.3mf, part 'a'"
    )


def test_without_metadata_a_part_is_made_once_as_it_is():
    found = parsed()
    assert (found.quantity, found.value) == (1, None)
    assert np.array_equal(found.orientations.matrices, JobMetadata().orientations.matrices)


def test_settings_are_read():
    found = parsed(quantity=" 12 ", value="2.5", rotations="z90")
    assert (found.quantity, found.value) == (12, 2.5)
    assert len(found.orientations.matrices) == 4
    assert parsed(quantity=str(MOST_COPIES)).quantity == MOST_COPIES


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "", "two", "٣", "9" * 12, str(MOST_COPIES + 1)])
def test_a_quantity_that_is_no_number_of_copies_is_refused(text):
    with pytest.raises(InputError, match=r"job.3mf, part 'a': expected a quantity from 1 to 100000"):
        parsed(quantity=text)


@pytest.mark.parametrize("text", ["-0.1", "nan", "inf", "", "dear"])
def test_a_value_below_0_or_without_size_is_refused(text):
    with pytest.raises(InputError, match=r"job.3mf, part 'a': expected a value of at least 0"):
        parsed(value=text)


def test_unknown_rotations_are_refused():
    with pytest.raises(InputError, match=r"job.3mf, part 'a': "):
        parsed(rotations="sideways")


def test_metadata_of_other_programs_are_kept_and_ours_are_not():
    theirs = {("", "Title"): "Bracket", ("http://example.org", "quantity"): "7"}
    assert foreign_metadata({**theirs, (NAMESPACE, "quantity"): "2"}) == theirs
