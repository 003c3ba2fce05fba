"""Narrow ends and waists of outlines, in one section and in many at once."""

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold, OpType

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.slicing.contours import SlicedMesh
from amprep.geometry.supports.narrow_ends import narrow_ends, narrow_ends_in
from amprep.geometry.supports.outlines import contours_in, contours_of, plane_outlines

WIDTH, AREA = 0.28, 0.07


def strip(width, length, turn=0.0):
    return CrossSection.square((length, width)).rotate(turn)


def test_a_wedge_whose_end_is_a_little_wider_than_the_width_has_a_narrow_end():
    wedge = CrossSection([np.array([[0.0, 0.0], [0.29, 0.0], [0.2, 3.0], [0.05, 3.0]])])
    assert len(narrow_ends(contours_of(wedge), WIDTH))


@pytest.mark.parametrize("turn", [0.0, 17.0, 45.0, 80.0])
def test_walls_of_the_width_that_cross_have_no_narrow_ends(turn):
    strips = [strip(0.3, 4.0, 45.0 + side) for side in (0.0, 90.0)]
    cross = CrossSection.batch_boolean([*strips, strip(0.3, 4.0, 225.0), strip(0.3, 4.0, 315.0)], OpType.Add)
    assert len(narrow_ends(contours_of(cross.rotate(turn)), WIDTH)) == 0


def comb():
    """A block with fins and pins of many widths, which change with the height."""
    solids = [Manifold.cube((12.0, 2.0, 4.0)), Manifold.cylinder(4.0, 0.3, 0.05).translate((20.0, 0.0, 0.0))]
    for number, width in enumerate(np.linspace(0.05, 0.5, 10)):
        fin = CrossSection.square((width, 3.0)).extrude(3.0, scale_top=(1.0 + 0.1 * number, 1.0))
        solids.append(fin.translate((1.1 * number + 0.2, 1.5, 0.0)))
        solids.append(Manifold.cube((width, width, 2.5)).translate((1.1 * number, -2.0, 0.0)))
    return Manifold.batch_boolean(solids, OpType.Add)


@pytest.mark.parametrize("waists", [True, False])
def test_sections_looked_at_together_have_the_narrow_ends_that_each_has_alone(waists):
    heights = np.array([-1.0, 0.1, 0.7, 1.3, 2.2, 2.7, 3.3, 5.0])
    outlines = plane_outlines(SlicedMesh(*arrays_of(comb())).contours(heights))
    together = narrow_ends_in(outlines, [waists] * len(heights), WIDTH, AREA)
    alone = [
        narrow_ends(contours_in(outlines, plane), WIDTH, AREA, waists=waists) for plane in range(len(heights))
    ]
    assert [len(ends) for ends in alone[:1] + alone[-1:]] == [0, 0]
    assert len(alone[1]) > 10
    for plane, ends in enumerate(alone):
        np.testing.assert_array_equal(together.get(plane, np.empty((0, 2))), ends)


def test_a_plane_may_be_looked_at_without_waists():
    blocks = CrossSection.square((3.0, 1.0)) + CrossSection.square((3.0, 1.0)).translate((0.0, 2.0))
    region = blocks + CrossSection.square((0.1, 1.2)).translate((1.5, 0.9))
    outlines = plane_outlines(SlicedMesh(*arrays_of(region.extrude(2.0))).contours(np.array([0.5, 1.5])))
    assert list(narrow_ends_in(outlines, [False, True], WIDTH, AREA)) == [1]


def test_no_sections_have_no_narrow_ends():
    outlines = plane_outlines(SlicedMesh(*arrays_of(Manifold.cube())).contours(np.empty(0)))
    assert narrow_ends_in(outlines, [], WIDTH, AREA) == {}
