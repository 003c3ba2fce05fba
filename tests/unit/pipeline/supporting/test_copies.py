"""Equal copies share the supports of one of them, moved, only where nothing else is near and the border is as far."""

import numpy as np
import pytest
from tests.shared.builds import QUARTER_TURN, box_mesh, placement

import amprep
from amprep.model import Part, PlacedPart, Stop
from amprep.model.mesh import join_meshes
from amprep.pipeline.packing import PackedBuild
from amprep.pipeline.record import build_record
from amprep.pipeline.stages import Clock, ProgressWatcher
from amprep.pipeline.supporting import support_build
from amprep.pipeline.supporting.copies import find_equal_copies
from amprep.pipeline.verifying.build import verify_build

TABLE = Part("table", join_meshes([box_mesh((0, 0, 0), (2, 4, 6)), box_mesh((0, 0, 5.99), (8, 4, 2))]), 110.0)
SHELF = Part("shelf", box_mesh((0, 0, 0), (6, 4, 2)), 48.0)
STATED = {"supports.pitch_mm": 1.0, "packing.clearance_mm": 4.0, "cells.strategy": "prism"}
MIDDLE = [(40.0, 60.0), (52.3, 60.0), (64.77, 61.5)]


@pytest.fixture(scope="module")
def resolved():
    return amprep.load(TABLE, settings=STATED).resolved


def placed(part, x, y, z=3.0, turn=None, label=None):
    return PlacedPart(label or part.name, part, placement(np.eye(3) if turn is None else turn, x, y, z))


def planned(resolved, *parts, **changes):
    copies = find_equal_copies(PackedBuild(resolved, 1, "copies.build-1", parts, **changes))
    return tuple(range(len(parts))) if copies is None else copies.planned


def test_copies_get_the_supports_of_the_first_one_moved(resolved):
    labels = ["table", "table-2", "table-3"]
    parts = tuple(placed(TABLE, x, y, label=label) for (x, y), label in zip(MIDDLE, labels, strict=True))
    build = PackedBuild(resolved, 1, "copies.build-1", (*parts, placed(SHELF, 40.0, 80.0)))
    made = support_build(build, Clock(ProgressWatcher()), Stop())
    assert [each.label for each in made.build.parts] == [*labels, "shelf"]
    assert [each.name for each in made.build.supports] == [
        f"supports of {each}" for each in (*labels, "shelf")
    ]
    first, *copies = made.build.supports[:3]
    for body, (x, y) in zip(copies, MIDDLE[1:], strict=True):
        moved = first.mesh.vertices + (x - MIDDLE[0][0], y - MIDDLE[0][1], 0.0)
        np.testing.assert_allclose(body.mesh.vertices, moved, atol=2e-5)
    assert verify_build(made.build).violations == ()
    record = build_record(made, resolved.job, Stop())
    squares = {
        label: [each.demand_squares for each in record.overhangs if each.part == label] for label in labels
    }
    assert squares["table"] == squares["table-2"] == squares["table-3"]
    assert sum(squares["table"]) > 0
    assert any("supports of 2 parts" in note for note in record.notes)


def test_unsupported_regions_and_figures_are_those_of_every_copy():
    hidden = join_meshes(
        [
            box_mesh((0, 0, 0), (12, 12, 1)),
            box_mesh((5, 5, 0.99), (1, 1, 5)),
            box_mesh((0, 0, 5.99), (12, 12, 1)),
        ]
    )
    part = Part("spool", hidden, 300.0)
    settings = {**STATED, "supports.grounding": "plate-only", "supports.drift_mm": 0.0}
    resolved = amprep.load(part, settings=settings).resolved
    parts = (placed(part, 40.0, 60.0), placed(part, 60.0, 63.0, label="spool-2"))
    made = support_build(PackedBuild(resolved, 1, "copies.build-1", parts), Clock(ProgressWatcher()), Stop())
    assert made.copies is not None
    one, other = ([each for each in made.build.unsupported if each.part == number] for number in (0, 1))
    assert len(one) == len(other) > 0
    for first, second in zip(one, other, strict=True):
        assert second.label == first.label + "-2"
        np.testing.assert_allclose(second.points, first.points + (20.0, 3.0, 0.0))
    assert len(made.removal) == len(made.build.supports)
    lost = build_record(made, resolved.job, Stop()).unconnected
    places = {
        label: sorted(each.position_mm for each in lost if each.part == label)
        for label in ("spool", "spool-2")
    }
    np.testing.assert_allclose(
        np.array(places["spool-2"]) - places["spool"], np.tile((20.0, 3.0, 0.0), (len(lost) // 2, 1))
    )


def test_copies_in_another_rotation_or_at_another_height_are_planned_by_themselves(resolved):
    turned, higher = placed(TABLE, 60.0, 60.0, turn=QUARTER_TURN), placed(TABLE, 80.0, 60.0, z=4.0)
    assert planned(resolved, placed(TABLE, 40.0, 60.0), turned, higher, placed(TABLE, 100.0, 60.0)) == (
        0,
        1,
        2,
    )


def test_copies_beside_something_else_are_planned_by_themselves(resolved):
    far = placed(TABLE, 40.0, 60.0), placed(TABLE, 40.0, 80.0), placed(TABLE, 40.0, 100.0)
    beside = placed(SHELF, 40.0 + 8.0 + 3.9, 80.0)
    assert planned(resolved, *far, beside) == (0, 1, 3)
    assert planned(resolved, *far, placed(SHELF, 40.0 + 8.0 + 4.0, 80.0)) == (0, 3)


def test_copies_at_the_border_share_supports_with_copies_as_near_to_it(resolved):
    assert planned(
        resolved, *(placed(TABLE, x, y) for x, y in [(60, 60), (1, 60), (1, 80), (0.5, 100), (60, 1)])
    ) == (0, 1, 3, 4)


def test_nothing_is_shared_where_supports_may_be_anywhere():
    resolved = amprep.load(TABLE, settings={**STATED, "supports.territory": "shared"}).resolved
    assert planned(resolved, *(placed(TABLE, x, y) for x, y in MIDDLE)) == (0, 1, 2)
