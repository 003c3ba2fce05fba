"""Simplified contours of one plane among many, against the sections of manifold3d."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.slicing.contours import SlicedMesh
from amprep.geometry.supports.outlines import contours_in, plane_outlines
from amprep.kernels.slicing.straight import keep_bends

TOLERANCE = 0.003


def bends_of(points):
    kept = np.zeros(len(points), np.bool_)
    keep_bends(np.asarray(points, np.float64), np.array([0, len(points)]), TOLERANCE, kept)
    return kept


def distances(points, polygon):
    """The distance of each point from the nearest side of a closed polygon."""
    start, side = polygon, np.roll(polygon, -1, axis=0) - polygon
    length = np.maximum((side**2).sum(axis=1), 1e-300)
    along = np.clip(((points[:, None] - start) * side).sum(axis=2) / length, 0.0, 1.0)
    return np.linalg.norm(points[:, None] - start - along[:, :, None] * side, axis=2).min(axis=1)


def test_only_the_corners_of_a_square_stay_wherever_it_begins():
    sides = [(x, 0) for x in range(5)] + [(5, y) for y in range(5)]
    sides += [(5 - x, 5) for x in range(5)] + [(0, 5 - y) for y in range(5)]
    for turn in range(0, len(sides), 3):
        points = np.roll(np.array(sides, np.float64), turn, axis=0)
        assert sorted(map(tuple, points[bends_of(points)].tolist())) == [(0, 0), (0, 5), (5, 0), (5, 5)]


@given(
    st.lists(st.floats(0.9, 1.1), min_size=3, max_size=60),
    st.floats(0.01, 5.0),
)
def test_what_is_left_out_is_near_what_stays(radii, size):
    angles = np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    points = size * np.array(radii)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    kept = bends_of(points)
    assert distances(points, points[kept]).max() <= TOLERANCE + 1e-12


def test_contours_of_a_plane_enclose_the_section_of_the_solid():
    ball = Manifold.sphere(5.0, 96) - Manifold.cylinder(20.0, 1.0, circular_segments=64, center=True)
    outlines = plane_outlines(SlicedMesh(*arrays_of(ball)).contours(np.array([-6.0, -2.0, 0.13, 3.0])))
    assert contours_in(outlines, 0).contours == []
    for plane, height in ((1, -2.0), (2, 0.13), (3, 3.0)):
        found, section = contours_in(outlines, plane), ball.slice(height)
        assert len(found.contours) == 2
        difference = (found.whole() - section).area() + (section - found.whole()).area()
        assert difference <= TOLERANCE * 2.0 * np.pi * 6.0
        assert (found.low <= found.high).all()
