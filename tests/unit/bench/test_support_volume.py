"""The benchmark of support volume measures what it says."""

import json

import numpy as np
import pytest

from amprep.bench.prusaslicer import support_in
from amprep.bench.support_volume import compare, free_below, generated_parts, straight_columns
from amprep.checks.supports.plan import check_plan
from amprep.host import Host
from amprep.model import Grid, Stop, SupportProblem, Voxel, silent
from amprep.supports.grid.red_squares import RedSquares


def test_only_extrusion_of_support_counts_in_g_code():
    code = """;TYPE:External perimeter
G1 X1 Y1 E5.0
;TYPE:Support material
G1 X2 Y1 E1.5
G1 X2 Y2 F3000
G1 E-0.8 F2100
G1 E0.8
;TYPE:Support material interface
G1 F1200 X3 Y3 E.5
;TYPE:Solid infill
G1 X9 Y9 E9"""
    assert support_in(code) == pytest.approx(2.0 * np.pi * 1.75**2 / 4)


def test_straight_columns_are_a_valid_plan_for_the_squares_with_a_free_column_below():
    voxels = np.full((6, 4, 4), Voxel.FREE, np.uint8)
    voxels[2, 1, 1] = Voxel.OCCUPIED
    square = np.array([[5, 1, 1], [5, 2, 2], [3, 2, 2], [0, 3, 3]], np.int32)
    nothing = np.zeros(4, np.int32)
    keep = free_below(voxels, RedSquares(square, nothing, nothing, nothing))
    assert keep.tolist() == [False, True, True, False], "the first has a part below, the last is on the plate"
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    problem = SupportProblem(
        grid, voxels, square[keep], nothing[keep], nothing[keep], voxels[0] == Voxel.FREE
    )
    plan = straight_columns(problem, Stop(), silent)
    assert check_plan(problem, plan) == []
    assert plan.edges.flow.sum() == 5 + 3


def test_merging_supports_take_less_volume_than_straight_columns_below_a_high_overhang():
    host = Host.load(plugins_enabled=False)
    settings = {"routers": ["shortest-paths"], "cell": "prism", "pitch": 3.0, "slicer": None, "stop": Stop()}
    result = compare("hook", generated_parts()["hook"], host, **settings)
    assert 0 < result.record["fraction_of_straight"]["shortest-paths"] < 0.7
    assert result.contact_mm2 == pytest.approx(27 * 12, rel=0.35)
    assert set(json.loads(json.dumps(result.record))["prusaslicer_mm3"].values()) == {None}
