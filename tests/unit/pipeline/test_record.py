"""The record of a run has the bounding volumes that were packed, each around its part, and the excess of pieces."""

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.builds import box_mesh
from tests.shared.solids import mesh_of

import amprep
from amprep.measures.bounding_volume import points_of
from amprep.model import Part
from amprep.model.mesh import join_meshes
from amprep.pipeline.outputs import OutputFolder
from amprep.pipeline.record import run_record
from amprep.stl import write_stl

BRACKET = join_meshes([box_mesh((5, 5, 5), (30, 10, 10)), box_mesh((5, 5, 14), (10, 10, 20))])


@pytest.fixture
def record(tmp_path):
    write_stl(BRACKET, tmp_path / "bracket.stl")
    settings = {
        "packing.volumes": ("boxes-two",),
        "packing.objective": "fill",
        "supports.enabled": False,
        "packing.clearance_mm": 1.0,
    }
    table = {"size_mm": [45.0, 45.0, 40.0], "name": "small"}
    path = f"{tmp_path / 'bracket.stl'}:9"
    return amprep.run(path, output=tmp_path / "out", printer=table, settings=settings, dry_run=True)


def test_the_volume_of_each_part_is_around_it_in_its_build(record):
    (build,) = record.builds
    assert len(build.volumes) == len(build.build.parts) > 1
    for each in build.volumes:
        points = points_of(each.volume) @ each.matrix[:3, :3].T + each.matrix[:3, 3]
        placed = build.build.parts[each.part].mesh
        np.testing.assert_allclose(points.min(axis=0), placed.bounds[0], atol=1e-3)
        np.testing.assert_allclose(points.max(axis=0), placed.bounds[1], atol=1e-3)


def test_a_fill_run_knows_the_value_that_it_reached_and_that_of_each_copy(record):
    parts = record.builds[0].build.parts
    volume = parts[0].part.volume_mm3
    assert record.reached == pytest.approx(len(parts) * volume)
    assert [each.value for each in record.unplaced] == pytest.approx([volume] * 5)
    assert len(parts) == 4


@pytest.fixture
def bowls(tmp_path):
    """Two bowls and a block, packed as true shapes, and the record of any packing of them."""
    bowl = mesh_of(Manifold.sphere(10.0, 24) - Manifold.sphere(8.0, 24).translate([0.0, 0.0, 6.0]))
    parts = (
        Part("bowl", bowl, bowl.signed_volume, quantity=2),
        Part("block", box_mesh((0, 0, 0), (9, 9, 9)), 729.0),
    )
    settings = {
        "packing.strategy": "separation",
        "packing.stacking": True,
        "packing.objective": "height",
        "packing.params": {"work": 5.0},
        "supports.enabled": False,
    }
    table = {"size_mm": [30.0, 30.0, 200.0], "name": "small"}
    loaded = amprep.load(*parts, printer=table, settings=settings)
    packed = amprep.pack(loaded)
    return packed, lambda packing: run_record(
        loaded, replace(packed, packing=packing), (), OutputFolder(tmp_path, "job")
    )


def test_the_record_has_the_excess_of_each_part_by_its_name(bowls):
    packed, recorded = bowls
    excess = recorded(packed.packing).excess
    assert list(excess) == ["block", "bowl"]
    assert excess["block"] == pytest.approx(0.0, abs=1e-4)
    bowl = packed.problem.items[0].volume.mesh
    hull = Manifold.hull_points(bowl.vertices).volume() / bowl.signed_volume - 1.0
    assert 0.0 < excess["bowl"] < hull


def test_of_copies_with_different_pieces_the_greatest_excess_counts_and_only_that_of_placed_ones(bowls):
    packed, recorded = bowls
    given = replace(packed.packing, excess={0: 0.3, 1: 0.1, 2: 0.0})
    assert recorded(given).excess == {"block": 0.0, "bowl": 0.3}
    without_first = tuple(tuple(each for each in build if each.item != 0) for build in given.builds)
    assert recorded(replace(given, builds=without_first)).excess == {"block": 0.0, "bowl": 0.1}
    assert recorded(replace(given, builds=())).excess == {}
    assert recorded(replace(given, excess={})).excess == {}
