"""Outlines for the 2D package contain the shadows, and its plates stand before the same judges."""

import numpy as np
import pytest
import trimesh
from manifold3d import CrossSection, FillRule, Manifold

from amprep.bench.plates.rivals import SMOOTHING, outline_of, spyrrow_plates
from amprep.bench.plates.run import read_scene
from amprep.errors import InputError


@pytest.mark.parametrize(
    "solid",
    [
        lambda: Manifold.cylinder(5, 20, 20, 64) - Manifold.cylinder(5, 15, 15, 64),
        lambda: Manifold.cube([4, 4, 4]) + Manifold.cube([4, 4, 4]).translate([9, 9, 0]),
        lambda: sum((Manifold.cube([2, 2, 2]).translate([5 * k, 0, 0]) for k in range(4)), Manifold()),
    ],
)
def test_the_outline_is_one_polygon_that_contains_the_shadow(solid):
    shadow = solid().project()
    points, area = outline_of(shadow)
    polygon = CrossSection([points], FillRule.Positive)
    assert (shadow - polygon).area() == pytest.approx(0.0, abs=1e-9)
    assert polygon.area() == pytest.approx(area)
    wider = shadow.offset(SMOOTHING, circular_segments=32)
    solid_part = CrossSection([max(wider.to_polygons(), key=len)], FillRule.Positive) + wider
    assert area <= solid_part.area() + 30 * SMOOTHING


def test_parts_that_may_be_tipped_are_refused(tmp_path):
    trimesh.creation.box((8.0, 6.0, 4.0)).export(tmp_path / "box.stl")
    with pytest.raises(InputError, match="--rotations"):
        spyrrow_plates(read_scene([tmp_path], (40.0, 40.0), 1.0, "axis"), seconds=1, seed=0)


def test_the_package_packs_valid_plates(tmp_path):
    pytest.importorskip("spyrrow")
    for k, size in enumerate(((30.0, 10.0, 5.0), (12.0, 12.0, 4.0), (18.0, 9.0, 3.0))):
        trimesh.creation.box(size).export(tmp_path / f"{k}.stl")
    trimesh.creation.box((39.0, 5.0, 5.0)).export(tmp_path / "too-long.stl")
    result = spyrrow_plates(read_scene([tmp_path], (40.0, 40.0), 1.0, "z90"), seconds=6, seed=1)
    assert result.faults == ()
    assert result.unplaced == 1
    assert result.plates == 1
    assert np.isclose(result.filled, (300 + 144 + 162) / 1600.0)
