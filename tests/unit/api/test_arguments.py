"""Mistakes of a Python caller raise errors of amprep that name the call, the value and what to do."""

import numpy as np
import pytest

import amprep
from amprep.errors import InputError
from amprep.model import Mesh
from amprep.testing import box_mesh

BOX = box_mesh(np.zeros(3), np.full(3, 10.0))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda parts, _: amprep.pack(3), "pack: expected LoadedParts, got int; pass the result of load"),
        (lambda _, packed: amprep.plan_supports(packed), "got PackedParts; pass one of the builds of pack"),
        (lambda _, packed: amprep.emit_cells(packed.builds[0]), "expected PlannedBuild, got PackedBuild"),
        (
            lambda _, packed: amprep.write(packed, "x.3mf"),
            "expected SupportedBuild or Build, got PackedParts",
        ),
        (lambda _, packed: amprep.verify(packed), "pass a path or the result of emit_cells"),
    ],
)
def test_a_record_of_the_wrong_step_is_refused_by_name(call, words):
    parts = amprep.load(BOX)
    with pytest.raises(InputError, match=words):
        call(parts, amprep.pack(parts))


@pytest.mark.parametrize("index", [-1, 8])
def test_triangles_that_refer_to_no_vertex_are_refused(index):
    triangles = BOX.triangles.copy()
    triangles[0, 0] = index
    with pytest.raises(InputError, match=f"vertices 0 to 7, got the index {index}"):
        amprep.load(Mesh(BOX.vertices, triangles))


def test_loaded_parts_are_counted_in_the_singular():
    assert str(amprep.load(BOX)) == "1 part, 1 copy: mesh"
