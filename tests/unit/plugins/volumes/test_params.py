"""Parameters of volume makers are bounded, and a message names the rule and the value."""

import re

import pytest

from amprep.plugins.volumes import params


@pytest.mark.parametrize(
    ("record", "given", "message"),
    [
        (params.BoundingMeshParams, {"cost": "edges"}, "cost must be volume or distance, got 'edges'"),
        (params.BoundingMeshParams, {"triangles": 3}, "triangles must be at least 4, got 3"),
        (params.BoundingMeshParams, {"fraction": 1.5}, "fraction must be between 0.0 and 1.0, got 1.5"),
        (params.BoundingMeshParams, {"max_error_mm": 0.0}, "max_error_mm must be above 0.0, got 0.0"),
        (params.TwoBoxesParams, {"objective": "sum"}, "objective must be union or larger, got 'sum'"),
        (params.TwoBoxesParams, {"planes": 257}, "planes must be between 2 and 256, got 257"),
        (params.TwoRectanglesParams, {"objective": "sum"}, "objective must be union or larger, got 'sum'"),
        (params.BranchAndCutParams, {"boxes": 5}, "boxes must be between 2 and 4, got 5"),
        (params.BranchAndCutParams, {"cells": 65}, "cells must be between 2 and 64, got 65"),
        (params.BranchAndCutParams, {"work": 1e30}, "work must be between 0 and 1000000, got 1e+30"),
        (params.KMeansParams, {"boxes": 6}, "boxes must be between 2 and 5, got 6"),
        (params.KMeansParams, {"restarts": 10**9}, "restarts must be between 1 and 10000, got 1000000000"),
        (params.KMeansParams, {"cells": 1}, "cells must be between 2 and 256, got 1"),
        (params.ConvexPiecesParams, {"method": "hulls"}, "method must be cuts or surface, got 'hulls'"),
        (params.ConvexPiecesParams, {"pieces": 0}, "pieces must be between 1 and 1000, got 0"),
        (params.ConvexPiecesParams, {"excess": -0.1}, "excess must be at least 0, got -0.1"),
        (params.ConvexPiecesParams, {"concavity_mm": -1.0}, "concavity_mm must be at least 0, got -1.0"),
        (
            params.ConvexPiecesParams,
            {"concavity_mm": float("nan")},
            "concavity_mm must be at least 0, got nan",
        ),
    ],
)
def test_a_parameter_out_of_bounds_is_refused_with_rule_and_value(record, given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        record(**given)


def test_a_bounding_mesh_keeps_a_thousand_triangles_unless_a_number_is_asked_for():
    assert params.BoundingMeshParams().target(4000) == 1000
    assert params.BoundingMeshParams().target(40_000) == 4000
    assert params.BoundingMeshParams(fraction=0.05).target(4000) == 200
    assert params.BoundingMeshParams(triangles=50, fraction=0.5).target(4000) == 50
    assert params.BoundingMeshParams(fraction=0.0).target(4000) == 4
