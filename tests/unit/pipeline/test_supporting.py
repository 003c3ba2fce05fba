"""The reach of a job that states none follows from the pitch of the grid and from the contact spacing."""

import pytest
from tests.shared.builds import box_mesh

import amprep
from amprep.model import Part
from amprep.pipeline.supporting import usual_reach


@pytest.mark.parametrize(
    ("pitch", "spacing", "reach"),
    [(0.8, 0.0, 1.2), (2.0, 0.0, 3.0), (4.0, 0.0, 5.0), (0.4, 2.0, 1.6), (1.2, 2.0, 1.8), (3.0, 2.0, 2.0)],
)
def test_the_reach_is_at_most_the_spacing_and_reaches_the_middle_between_contacts(pitch, spacing, reach):
    assert usual_reach(pitch, spacing) == pytest.approx(reach)


def test_the_build_records_the_reach_that_judges_enforce():
    part = Part("slab", box_mesh((20, 20, 5), (20, 20, 2)), 800.0)
    for settings, reach in (({}, 2.0), ({"supports.reach_mm": 2.5}, 2.5)):
        loaded = amprep.load(part, settings={"supports.pitch_mm": 2.0, **settings})
        found = amprep.emit_cells(amprep.plan_supports(loaded))
        assert found.build.settings.reach == reach
