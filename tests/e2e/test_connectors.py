"""Each connector supports a table, a ledge and a knife edge, and the judges find no fault in the result."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of

import amprep
from amprep.model import Part

POST = Manifold.cube([3.0, 6.0, 7.0]).translate([0.0, 0.0, 0.0])
TOP = Manifold.cube([9.0, 6.0, 2.0]).translate([0.0, 0.0, 6.5])
KEEL = Manifold.hull_points(
    np.array(
        [[3, y, 6.6] for y in (0, 6)] + [[9, y, 6.6] for y in (0, 6)] + [[6, y, 5.0] for y in (0, 6)]
    ).tolist()
)
TABLE = Part("table", mesh_of(POST + TOP + KEEL), 150.0)


@pytest.mark.parametrize("connector", ["full", "teeth", "point", "extend"])
def test_a_table_with_a_keel_is_supported_by_each_connector(connector):
    settings = {"supports.pitch_mm": 1.5, "cells.strategy": "prism", "cells.connector": connector}
    made = amprep.emit_cells(amprep.plan_supports(amprep.load(TABLE, settings=settings)))
    assert len(made.build.supports) == 1
    assert [each for each in made.build.unsupported if not each.minor] == []
    assert amprep.verify(made.build).violations == ()
