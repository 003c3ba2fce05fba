"""Parts with ``rotations = "orient"`` get orientations with little support, and the packer chooses among these."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

import amprep
from amprep.errors import JobError
from amprep.model import Mesh, Part
from amprep.model.orientation import OrientationFigures, OrientationProposal, OrientationRules
from amprep.pipeline.orienting.rotations import worth_packing

SETTINGS = {"printer": "Prusa MK4", "packing.effort": "fast", "supports.enabled": False}


@pytest.fixture(scope="module")
def table():
    """A top of 20 x 20 x 2 mm on a leg of 4 x 4 x 10 mm, drawn on its leg."""
    top = trimesh.creation.box(bounds=[[-10, -10, 10], [10, 10, 12]])
    solid = trimesh.boolean.union([top, trimesh.creation.box(bounds=[[-2, -2, 0], [2, 2, 11]])])
    return Part("table", Mesh(solid.vertices, solid.faces), float(solid.volume))


def test_a_job_that_says_so_builds_the_table_upside_down(table):
    parts = amprep.load(table, settings={**SETTINGS, "packing.rotations": "orient"})
    assert parts.parts[0].orient == OrientationRules()
    packed = amprep.pack(parts, packer="extreme-points")
    (placed,) = packed.builds[0].parts
    assert placed.matrix[2, :3].tolist() == [0.0, 0.0, -1.0]
    assert len(placed.part.orientations.matrices) % 4 == 0
    assert any("table may be tilted by 180" in note for note in packed.notes)


def test_an_entry_restricts_the_search_of_its_part(table):
    entry = {"name": "table", "rotations": "orient", "face_up": ["+z"], "tilt_deg": 30}
    parts = amprep.load(table, settings={**SETTINGS, "part": [entry]})
    assert parts.parts[0].orient == OrientationRules(face_up=("+z",), tilt_deg=30.0)
    matrices = amprep.pack(parts, packer="extreme-points").builds[0].parts[0].part.orientations.matrices
    assert (matrices[:, 2, 2] >= np.cos(np.radians(30.0)) - 1e-9).all()


def test_rotations_of_an_entry_take_precedence_over_those_of_the_job(table):
    entry = {"name": "table", "rotations": "z90"}
    settings = {**SETTINGS, "packing.rotations": "orient", "part": [entry]}
    (part,) = amprep.load(table, settings=settings).parts
    assert (part.orient, len(part.orientations.matrices)) == (None, 4)


def test_a_part_with_fixed_positions_stays_as_drawn(table):
    entry = {"name": "table", "rotations": "orient", "fixed": [[20.0, 20.0, 0.0]]}
    packed = amprep.pack(amprep.load(table, settings={**SETTINGS, "part": [entry]}), packer="extreme-points")
    assert packed.builds[0].parts[0].matrix[2, 2] == 1.0
    assert "table stays as drawn, because it has fixed positions" in packed.notes


@pytest.mark.parametrize("wrong", [{"tilt_deg": 200}, {"face_up": [""]}])
def test_wrong_restrictions_are_refused(table, wrong):
    with pytest.raises(JobError):
        amprep.load(table, settings={"part": [{"name": "table", "rotations": "orient", **wrong}]})


def test_only_proposals_with_little_support_are_packed():
    figures = OrientationFigures(1.0, (1.0, 1.0, 1.0), 0.0, 0.0, 0.0, 0, 0.0, 0.0, 1.0, 0.0)
    proposals = tuple(
        OrientationProposal(np.eye(3), replace(figures, estimate=cost)) for cost in (140.0, 100.0, 134.0)
    )
    # at most 1.25 x 100 + 10
    assert [each.figures.estimate for each in worth_packing(proposals)] == [100.0, 134.0]
