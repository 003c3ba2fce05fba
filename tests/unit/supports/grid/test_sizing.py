"""Grids cover parts and their overhangs, stay in the build volume, and obey pitch and memory."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.errors import JobError
from amprep.model import BuildVolume, Part, PlacedPart
from amprep.overhangs.of_part import overhangs_of
from amprep.supports.grid.sizing import (
    FINEST_PITCH,
    USUAL_PITCH,
    choose_pitch,
    estimated_megabytes,
    lay_grid,
    usual_pitch,
)
from amprep.supports.rules import PlanningRules
from amprep.testing.problems import box_mesh

SPACE = BuildVolume((100.0, 80.0, 60.0))
RULES = PlanningRules()


def cube(side, at=(10.0, 10.0, 5.0)):
    mesh = box_mesh(np.zeros(3), np.full(3, side))
    matrix = np.eye(4)
    matrix[:3, 3] = at
    return PlacedPart("cube", Part("cube", mesh, side**3), matrix)


def test_the_median_part_has_twelve_voxels_along_its_mean_extent():
    assert usual_pitch([cube(12.0), cube(18.0), cube(50.0)]) == 1.5
    assert usual_pitch([cube(1.0)]) == usual_pitch([cube(1.0)], 0.3) == FINEST_PITCH
    assert usual_pitch([cube(1.0)], 0.6) == 1.6, "walls of 0.6 mm would close finer cells"
    assert usual_pitch([cube(90.0)]) == usual_pitch([]) == USUAL_PITCH


def test_the_pitch_is_that_of_the_rules_or_the_usual_one_or_the_first_that_fits_the_memory():
    parts = [cube(18.0)]
    assert choose_pitch(parts, SPACE, replace(RULES, pitch_mm=0.3)) == 0.3
    assert choose_pitch(parts, SPACE, RULES) == 1.5
    tight = replace(RULES, memory_mb=1)
    pitch = choose_pitch([cube(50.0)], SPACE, tight)
    assert pitch > USUAL_PITCH
    angle = RULES.strut_angle_deg
    assert estimated_megabytes([cube(50.0)], SPACE, pitch, angle) <= 1
    assert estimated_megabytes([cube(50.0)], SPACE, pitch / 1.2, angle) > 1


@examples(40)
@given(
    side=st.floats(2.0, 40.0),
    x=st.floats(0.0, 60.0),
    y=st.floats(0.0, 40.0),
    z=st.floats(0.5, 20.0),
    pitch=st.floats(0.7, 6.0),
)
def test_a_grid_covers_the_part_up_to_its_overhang_and_stays_in_the_build_volume(side, x, y, z, pitch):
    part = overhangs_of(cube(side, (x, y, z)), RULES)
    grid = lay_grid([part], SPACE, pitch, RULES)
    planes, rows, columns = grid.shape
    assert grid.step == pytest.approx(pitch * np.tan(np.radians(RULES.strut_angle_deg)))
    end = grid.origin + np.array([columns * pitch, rows * pitch, planes * grid.step])
    assert (grid.origin >= 0.0).all()
    assert (end[:2] <= np.asarray(SPACE.size)[:2] + 1e-6).all()
    lo, hi = part.mesh.bounds
    # an incomplete column of voxels at a wall is left out
    assert (grid.origin[:2] <= np.maximum(lo[:2], pitch) + 1e-6).all()
    assert (end[:2] >= hi[:2] - pitch).all()
    assert end[2] > z - 1e-6 or planes == int(SPACE.size[2] / grid.step)


def test_a_grid_that_takes_too_much_memory_is_refused_with_a_pitch_that_fits():
    part, rules = overhangs_of(cube(40.0), RULES), replace(RULES, memory_mb=1)
    with pytest.raises(JobError, match=r"more than supports\.memory_mb = 1") as caught:
        lay_grid([part], SPACE, 0.2, rules)
    advised = float(str(caught.value).split("supports.pitch_mm=")[1].split(")")[0])
    assert lay_grid([part], SPACE, advised, rules).shape[0] >= 1
