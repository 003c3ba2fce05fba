"""Disconnected components inside a region are separated; genus and counts are those of known solids."""

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.components import count_components, drop_detached, genus_of


def box(low, size):
    return Manifold.cube(size).translate(low)


def block():
    return box([0, 0, 0], [10, 10, 10])


def region():
    return box([2, 2, 2], [6, 6, 6])


def torus():
    return CrossSection.circle(1.0, 12).translate((3.0, 0.0)).revolve(24)


@pytest.mark.parametrize(
    ("solid", "genus"),
    [
        (block, 0),
        (torus, 1),
        (lambda: torus() + torus().translate([20.0, 0.0, 0.0]), 2),
        (lambda: block() - box([4, 4, -1], [1, 1, 12]) - box([6, 6, -1], [1, 1, 12]), 2),
        (lambda: block() - region(), 0),
    ],
)
def test_the_genus_counts_the_handles_of_all_shells(solid, genus):
    assert genus_of(*arrays_of(solid())) == genus


def test_components_are_counted_without_voids_and_fragments():
    crumb = box([20, 0, 0], [0.01, 0.01, 0.01])
    assert count_components(*arrays_of(block() - region() + box([4, 4, 4], [1, 1, 1]) + crumb)) == 2
    assert count_components(np.empty((0, 3)), np.empty((0, 3), np.int64)) == 0


def test_what_floats_in_the_region_is_detached_with_its_voids():
    floating = box([3, 3, 3], [3, 3, 3]) - box([4, 4, 4], [1, 1, 1])
    held = box([1, 7, 7], [4, 0.5, 0.5])
    filled = arrays_of(block() - region() + floating + held)
    split = drop_detached(*filled, arrays_of(region()), arrays_of(block()))
    assert split.components == 1
    assert volume(split.detached) == pytest.approx(27 - 1)
    assert volume(split.kept) == pytest.approx(1000 - 216 + 3 * 0.25)


def test_a_solid_without_detached_components_is_returned_unchanged():
    points, triangles = arrays_of(block() - region())
    split = drop_detached(points, triangles, arrays_of(region()), arrays_of(block()))
    assert split.kept[0] is points
    assert split.components == len(split.detached[1]) == 0


def test_of_a_part_completely_inside_the_region_the_largest_remains():
    whole = box([3, 3, 3], [4, 4, 4])
    remains = box([3, 3, 3], [1, 1, 1]) + box([5, 5, 5], [2, 2, 2])
    split = drop_detached(*arrays_of(remains), arrays_of(region()), arrays_of(whole))
    assert (split.components, volume(split.kept)) == (1, pytest.approx(8.0))


def volume(mesh):
    points, triangles = mesh
    corners = points[triangles]
    return np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
