"""The judge of orientations finds wrong rotations and wrong figures."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from amprep.checks.orientation import check_proposal
from amprep.model.mesh import Mesh
from amprep.model.orientation import OrientationProposal
from amprep.model.part import Part
from amprep.model.rotations import axis_rotations
from amprep.model.supports.rules import SupportRules
from amprep.orienting.measure import measure_orientation

RULES = SupportRules(rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0, plate_mm=0.06)
HOOK = trimesh.boolean.union(
    [
        trimesh.creation.box(bounds=[[0, 0, 0], [8, 12, 40]]),
        trimesh.creation.box(bounds=[[0, 0, 34], [35, 12, 40]]),
    ]
)
PART = Part("hook", Mesh(HOOK.vertices, HOOK.faces), float(HOOK.volume))


def proposal(rotation, lift=0.0):
    return OrientationProposal(rotation, measure_orientation(PART, rotation, RULES, lift))


@pytest.fixture(scope="module")
def true():
    return proposal(np.eye(3))


@pytest.mark.parametrize("lift", [0.0, 3.0])
@pytest.mark.parametrize("number", [0, 7, 15])
def test_measured_figures_are_true(number, lift):
    assert check_proposal(PART, proposal(axis_rotations()[number], lift), RULES, lift) == []


def test_a_matrix_that_is_no_rotation_is_found():
    mirrored = replace(proposal(np.eye(3)), rotation=np.diag([1.0, 1.0, -1.0]))
    (found,) = check_proposal(PART, mirrored, RULES, 0.0)
    assert "expected a rotation" in found.message


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"box_mm": (35.0, 12.0, 41.0)}, "expected a box"),
        ({"height_mm": 39.0}, "expected a box"),
        ({"tipping_deg": 3.0}, "expected to tip over"),
        ({"overhang_mm2": 250.0}, "expected overhangs"),
        ({"overhang_mm2": 390.0}, "expected overhangs"),
        ({"shadow_mm3": 7000.0}, "expected a shadow volume"),
    ],
)
def test_a_wrong_figure_is_found(true, wrong, words):
    found = check_proposal(PART, replace(true, figures=replace(true.figures, **wrong)), RULES, 0.0)
    assert [words in each.message for each in found] == [True]
