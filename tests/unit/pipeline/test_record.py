"""The record of a run has the bounding volumes that were packed, each around its part."""

import numpy as np
import pytest
from tests.shared.builds import box_mesh

import amprep
from amprep.measures.bounding_volume import points_of
from amprep.model.mesh import join_meshes
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
