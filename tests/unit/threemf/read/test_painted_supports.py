"""Painted supports are decoded as PrusaSlicer means them; damaged codes are reported."""

import numpy as np
import pytest
from tests.shared.optional import present

from amprep.threemf.package.painted_supports import PaintedSupports, find_painted_supports
from amprep.threemf.read.painted_supports import decode, painted_regions

A, B, C, AB, BC, CA = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])


@pytest.mark.parametrize(
    ("code", "corners"),
    [
        ("4", (A, B, C)),
        ("041", (BC, C, A)),
        ("401", (A, B, BC)),
        ("045", (CA, A, B)),
        ("049", (AB, B, C)),
        ("0042", (B, C, CA)),
        ("4002", (A, AB, CA)),
        ("0406", (BC, C, AB)),
        ("400A", (C, CA, BC)),
        ("00043", (AB, BC, CA)),
        ("40003", (A, AB, CA)),
    ],
)
def test_painted_triangles_agree_with_the_supports_that_prusaslicer_makes(code, corners):
    """Compared with where PrusaSlicer 2.5 places supports when it slices a plate painted with the same code."""
    painted, states = decode(code)
    assert states.tolist() == [1]
    assert sorted(map(tuple, painted[0])) == sorted(map(tuple, np.array(corners, float)))


def test_a_subdivided_triangle_may_be_subdivided_again():
    painted, states = decode("000" + "00043" + "3")
    assert states.tolist() == [1]
    assert np.linalg.det(painted[0]) == pytest.approx(1 / 16), "fraction of the triangle's area"


def test_unknown_states_are_read_and_ignored():
    assert decode("8")[1].tolist() == [2]
    assert len(decode("0")[0]) == 0
    assert len(decode("5C")[0]) == 0, "a state above 2, in two digits"


@pytest.mark.parametrize("code", ["1", "41", "44", "4D", "000041", "1" * 5000])
def test_a_damaged_code_is_an_error(code):
    with pytest.raises(ValueError, match="the code "):
        decode(code)


def test_a_damaged_code_is_noted_and_the_rest_is_kept():
    model = b"""<model><object id="7"><mesh><triangles><triangle v1="0" v2="1" v3="2"/>
    <triangle v1="0" v2="2" v3="3" slic3rpe:custom_supports="4"/><triangle paint_supports="41" v1="0" v2="2" v3="4"/>
    </triangles></mesh></object><object id="8" name="a > b"><triangles><triangle/></triangles></object></model>"""
    ((object_id, painted),) = find_painted_supports(model).items()
    assert (object_id, painted) == (7, PaintedSupports(3, {1: "4", 2: "41"}))
    corners = np.array([[0, 1, 2], [0, 2, 3], [0, 2, 4]])
    regions, note = painted_regions(painted, np.zeros((5, 3)), corners, np.array([False, True, True]), 10)
    assert [(region.kind, present(region.triangles).tolist()) for region in regions] == [("enforcer", [10])]
    assert note == "dropped painted supports of 1 triangle: damaged or too fine"
    assert painted_regions(painted, np.zeros((5, 3)), corners[:2], np.ones(2, bool), 0)[1]
