"""Volume makers are compared over all parts: ratios, failures, and volumes that leave something out."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.checks.violation import Violation
from amprep.model import Boxes, Part, TurnedVolume
from amprep.report.inspection.compare import compare_makers
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord

MADE = TurnedVolume(Boxes([[0, 0, 0]], [[1, 1, 1]]), np.eye(3))
PART = Part("cube", box_mesh((0, 0, 0), (1, 1, 1)), 1.0)
BROKEN = (Violation("volume contains part", "cube", "not all of it"),)


def test_each_maker_has_its_figures_over_all_parts():
    first = InspectedPart(
        PART, volumes=(InspectedVolume("a", MADE, 2.0, 2.0, seconds=1.0), InspectedVolume("b", failure="no"))
    )
    second = InspectedPart(
        PART,
        volumes=(
            InspectedVolume("a", MADE, 4.0, 4.0, seconds=3.0, violations=BROKEN),
            InspectedVolume("b", MADE, 1.0, None, seconds=5.0),
        ),
    )
    a, b = compare_makers(InspectionRecord("job", "1", (), (first, second)))
    assert (a.makers, a.ratio, a.greatest_ratio, a.seconds) == ("a", 3.0, 4.0, 2.0)
    assert (a.outside, a.not_made) == (1, 0)
    assert (b.ratio, b.greatest_ratio, b.outside, b.not_made) == (None, None, 0, 1)
    assert b.seconds == pytest.approx(5.0)


def test_faults_are_problems_and_volumes_that_leave_something_out():
    part = InspectedPart(
        PART, problems=("open",), volumes=(InspectedVolume("a", MADE, 4.0, 4.0, violations=BROKEN),)
    )
    assert InspectionRecord("job", "1", (), (part,)).faults == 2
