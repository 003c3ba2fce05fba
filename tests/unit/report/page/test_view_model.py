"""The data of the 3D view: bounding volumes with the colours of their pieces."""

from dataclasses import replace

import numpy as np

from amprep.model import Boxes
from amprep.report.page.geometry import GeometryPack
from amprep.report.page.view_model import view_model, volume_model
from amprep.report.record import BuildRecord, RunRecord, ShownVolume

BOXES = Boxes([[0, 0, 0], [5, 0, 0]], [[5, 5, 5], [9, 9, 9]])


def test_copies_share_the_mesh_of_their_volume_and_keep_their_matrices(make_build):
    away = np.eye(4)
    away[0, 3] = 20.0
    shown = (ShownVolume(0, BOXES, np.eye(4)), ShownVolume(0, BOXES, away))
    record = RunRecord("job", "1", 0, "MK4", "generic", (BuildRecord(make_build(), volumes=shown),))
    model, _ = view_model(record)
    ((choice,),) = [build["volumes"] for build in model["builds"]]
    one, other = choice["shown"]
    assert one["mesh"] == other["mesh"]
    assert one["pieces"] == [8, 8]
    assert (one["matrix"][3], other["matrix"][3]) == (0.0, 20.0)
    assert model["meshes"][one["mesh"]]["triangles"] == 24


def test_a_build_that_was_not_packed_offers_no_volumes(make_build):
    record = RunRecord("job", "1", 0, "MK4", "generic", (BuildRecord(make_build()),))
    assert [build["volumes"] for build in view_model(record)[0]["builds"]] == [[]]
    assert [build["volumes"] for build in view_model(replace(record, builds=()))[0]["builds"]] == []


def test_pieces_have_several_colours_and_a_single_one_its_own():
    two = volume_model(BOXES, np.eye(4), GeometryPack(), "two", [])
    one = volume_model(Boxes(BOXES.lo[:1], BOXES.hi[:1]), np.eye(4), GeometryPack(), "one", [])
    assert len(set(two["colours"])) > 1
    assert len(one["colours"]) == 1
