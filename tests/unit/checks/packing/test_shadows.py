"""The check of plates as polygons agrees with distances known by hand, and with samples of the contours."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from tests.shared.examples import examples
from tests.shared.solids import mesh_of

from amprep.checks.packing.shadows import Shadow, check_shadows, shadow_of, shadows_of
from amprep.model import BuildVolume, Mesh, Part, PlacedPart

PLATE = BuildVolume(np.array([100.0, 80.0, 50.0]))


def part(solid):
    return Part("part", mesh_of(solid), solid.volume())


def placed(shape, x, y, angle=0.0, label="a"):
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])
    return PlacedPart(label, shape, matrix)


def promises(*parts, clearance=2.0, space=PLATE):
    return [found.promise for found in check_shadows(shadows_of(parts), space, clearance)]


def test_shadows_keep_the_clearance_from_one_another_and_from_the_walls():
    cube = part(Manifold.cube([10, 10, 10]))
    assert promises(placed(cube, 2, 2), placed(cube, 14, 2)) == []
    assert promises(placed(cube, 2, 2), placed(cube, 13.99, 2)) == ["shadows apart"]
    assert promises(placed(cube, 1.99, 2)) == ["shadow inside plate"]
    assert promises(placed(cube, 2, 68.01)) == ["shadow inside plate"]
    # 1.5 apart in x and in y is 2.12 apart
    assert promises(placed(cube, 2, 2), placed(cube, 13.5, 13.5)) == []
    assert promises(placed(cube, 2, 2), placed(cube, 13.4, 13.4)) == ["shadows apart"]


def test_shadows_that_touch_do_not_overlap():
    cube = part(Manifold.cube([10, 10, 10]))
    assert promises(placed(cube, 0, 0), placed(cube, 10, 0), clearance=0.0) == []
    assert promises(placed(cube, 0, 0), placed(cube, 9.99, 0), clearance=0.0) == ["shadows apart"]


def test_a_part_in_the_hole_of_another_is_apart_and_one_below_an_overhang_is_not():
    ring = part(Manifold.cylinder(5, 20, 20, 64) - Manifold.cylinder(5, 15, 15, 64))
    peg = part(Manifold.cylinder(5, 10, 10, 64))
    assert promises(placed(ring, 40, 40), placed(peg, 40, 40)) == []
    assert promises(placed(ring, 40, 40), placed(peg, 44, 40)) == ["shadows apart"]
    table = part(Manifold.cube([20, 20, 2]).translate([0, 0, 20]) + Manifold.cube([2, 2, 20]))
    cube = part(Manifold.cube([5, 5, 5]))
    assert promises(placed(table, 10, 10), placed(cube, 18, 18)) == ["shadows apart"]


def test_a_round_plate_has_a_round_wall():
    space = BuildVolume(np.array([20.0, 20.0, 20.0]), "cylinder")
    cube = part(Manifold.cube([10, 10, 10]))
    assert promises(placed(cube, 5, 5), space=space) == []
    assert promises(placed(cube, 7, 5), space=space) == ["shadow inside plate"]


def test_the_shadow_of_a_surface_is_what_its_triangles_cover():
    sheet = Part(
        "sheet", Mesh([[0, 0, 0], [0, 4, 3], [6, 0, 0]], [[0, 1, 2], [0, 2, 1]]), 0.0, is_solid=False
    )
    assert shadow_of(sheet, np.eye(3)).area() == pytest.approx(12.0)
    upright = Part("wall", Mesh([[0, 0, 0], [0, 0, 3], [6, 0, 0]], [[0, 1, 2]]), 0.0, is_solid=False)
    assert promises(placed(upright, 2, 2)) == []


@examples(40)
@given(st.integers(0, 10**6), st.floats(0.05, 3.0))
def test_distances_agree_with_samples_of_the_contours(seed, clearance):
    rng = np.random.default_rng(seed)
    one = CrossSection.hull_points(rng.uniform(20, 30, (6, 2)))
    other = CrossSection.hull_points(rng.uniform(20, 30, (6, 2)) + rng.uniform(-12, 12, 2))
    found = check_shadows([Shadow("a", one), Shadow("b", other)], PLATE, clearance)
    apart = (one ^ other).is_empty()
    steps = np.linspace(0, 1, 80, endpoint=False)[:, None, None]
    points = [
        (corners + steps * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)
        for corners in (np.asarray(each.to_polygons()[0]) for each in (one, other))
    ]
    least = np.linalg.norm(points[0][:, None] - points[1][None], axis=2).min()
    broken = any(each.promise == "shadows apart" for each in found)
    if not apart and (one ^ other).area() > 0.1:
        assert broken
    elif apart and abs(least - clearance) > 0.1:
        assert broken == (least < clearance)
