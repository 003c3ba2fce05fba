"""Figures of an inspection in words."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.measures.contents import measure_contents
from amprep.model import Orientations, Part
from amprep.model.rotations import quarter_turns
from amprep.report.inspection.words import contents_words


@pytest.mark.parametrize(
    ("allowed", "words"),
    [
        (Orientations(), "as it lies only"),
        (Orientations("list", np.array(quarter_turns()[1:2])), "1 rotation"),
        (Orientations("list", np.array(quarter_turns())), "4 rotations"),
        (Orientations("about-z"), "about-z"),
    ],
)
def test_the_orientations_that_a_part_allows_are_counted(allowed, words):
    part = Part("cube", box_mesh((0, 0, 0), (1, 1, 1)), 1.0, orientations=allowed)
    assert dict(contents_words(part, measure_contents(part)))["orientations"] == words
