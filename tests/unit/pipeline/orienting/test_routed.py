"""Supports of one part in several orientations are planned with the same pitch."""

import numpy as np
import trimesh

import amprep
from amprep.model import Mesh, Part, Stop
from amprep.pipeline.orienting.routed import routed_by


def test_a_table_on_its_top_needs_no_supports_and_on_its_leg_it_does():
    top = trimesh.creation.box(bounds=[[-6, -6, 6], [6, 6, 8]])
    solid = trimesh.boolean.union([top, trimesh.creation.box(bounds=[[-2, -2, 0], [2, 2, 7]])])
    part = Part("table", Mesh(solid.vertices, solid.faces), float(solid.volume))
    settings = {"printer": "Prusa MK4", "supports.rules": "thesis", "supports.enabled": False}
    routed = routed_by(amprep.load(part, settings=settings).resolved, Stop())
    volume, unsupported = routed(part, np.eye(3))
    # the columns below the top, 128 mm2 in plan and 6 mm high, are lattice cells
    assert 20.0 < volume < 128 * 6
    assert unsupported == 0
    assert routed(part, np.diag([1.0, -1.0, -1.0])) == (0.0, 0)
