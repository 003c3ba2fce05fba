"""A run with a gap: supports keep it from walls, still reach what they hold, and the judge can tell."""

from dataclasses import replace

import pytest
import trimesh
from manifold3d import Manifold

from amprep.checks.supports.xy_distance import PROMISE
from amprep.model.supports.rules import SupportRules
from amprep.pipeline.verifying.build import verify_build
from amprep.threemf import read_build


@pytest.fixture
def mushroom(tmp_path):
    """A slab of 24 mm on a round leg that stands aslant on no grid line."""
    solid = Manifold.cube((24, 24, 3)).translate((0, 0, 12))
    solid += Manifold.cylinder(12.5, 3.1, 3.6, 48).translate((11.3, 12.1, 0))
    mesh = solid.to_mesh64()
    path = tmp_path / "mushroom.stl"
    trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts).export(path)
    return path


def test_supports_keep_the_gap_from_a_leg_and_hold_the_slab(amprep, mushroom, tmp_path):
    sets = ["--set", "supports.pitch_mm=2", "--cell", "prism"]
    assert amprep("run", mushroom, *sets, "--set", "supports.gap_mm=0.5", "-o", tmp_path / "gap").code == 0
    assert amprep("verify", tmp_path / "gap" / "mushroom.build-1.3mf").code == 0
    assert amprep("run", mushroom, *sets, "-o", tmp_path / "none").code == 0
    build = read_build(tmp_path / "none" / "mushroom.build-1.3mf")
    asked = replace(build, settings=replace(build.settings, rules=SupportRules(gap_mm=0.5)))
    assert {each.promise for each in verify_build(asked).violations} == {PROMISE}


def test_with_a_gap_a_knife_edge_is_held_as_well(amprep, fixtures, tmp_path):
    sets = ["--set", "supports.gap_mm=0.5", "--set", "packing.lift_mm=3"]
    assert amprep("run", fixtures / "knife-edge.stl", *sets, "-o", tmp_path).code == 0
