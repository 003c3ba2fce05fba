"""Volumes get pieces that contain them, those first whose pieces waste most."""

from collections.abc import Iterator
from itertools import count
from typing import ClassVar

import numpy as np
import pytest
from manifold3d import Manifold, OpType
from tests.shared.convex_solids import part_of

from amprep.model import Mesh
from amprep.model.bounding_volume import Boxes, Solid
from amprep.model.control import Stop
from amprep.plugins.packers.separation.pieces import decompose_volumes


def tube(outer, inner, height):
    return Manifold.cylinder(height, outer, outer, 64) - Manifold.cylinder(3 * height, inner, inner, 64, True)


SOLIDS = [tube(20, 15, 10), tube(5, 4, 3), Manifold.sphere(8, 48)]
VOLUMES = [Solid(part_of(solid).mesh) for solid in SOLIDS]


class StopAfter(Stop):
    """Tells to stop when it was asked some times."""

    asked: ClassVar[Iterator[int]]
    times: ClassVar[int]

    def __call__(self):
        return next(self.asked) >= self.times

    def within(self, seconds):  # noqa: ARG002
        return self


def stop_after(times):
    """Return a stop that becomes true when it was asked some times."""
    return type("StopAfterTimes", (StopAfter,), {"asked": count(), "times": times})()


def copied(volumes):
    """Return the volumes with meshes that no decomposition knows."""
    return [Solid(Mesh(volume.mesh.vertices, volume.mesh.triangles)) for volume in volumes]


def outside(solid, pieces):
    union = Manifold.batch_boolean([Manifold.hull_points(piece) for piece in pieces], OpType.Add)
    return (solid - union).volume()


@pytest.mark.parametrize("times", [0, 1, 5, 30, 70, 140, 150, 1000])
def test_pieces_contain_their_solids_whenever_the_decomposition_is_stopped(times):
    found = decompose_volumes(copied(VOLUMES), [1, 1, 1], 40, stop_after(times))
    for solid, pieces in zip(SOLIDS, found.sets, strict=True):
        assert len(pieces.pieces) >= 1
        assert outside(solid, pieces.pieces) < 1e-4


def test_the_solid_that_wastes_most_is_refined_first():
    large, small, ball = decompose_volumes(VOLUMES, [1, 1, 1], 15, Stop()).sets
    assert len(large.pieces) > len(small.pieces) >= len(ball.pieces) == 1
    assert len(large.pieces) + len(small.pieces) + len(ball.pieces) <= 15


def test_copies_make_a_solid_worse():
    alone = decompose_volumes(VOLUMES, [1, 1, 1], 15, Stop()).sets[1]
    often = decompose_volumes(VOLUMES, [1, 500, 1], 15, Stop()).sets[1]
    assert len(often.pieces) > len(alone.pieces)


def test_the_excess_of_the_pieces_is_stated():
    found = decompose_volumes(VOLUMES, [1, 1, 1], 40, Stop()).sets
    for solid, pieces in zip(SOLIDS, found, strict=True):
        total = sum(Manifold.hull_points(piece).volume() for piece in pieces.pieces)
        assert pieces.excess == pytest.approx(total / solid.volume() - 1.0, rel=1e-4, abs=1e-6)


def test_boxes_are_taken_as_they_are_and_an_angle_exactly():
    angle = part_of(Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20])).mesh
    boxes, pieces = decompose_volumes([Boxes([[0, 0, 0]], [[1, 2, 3]]), Solid(angle)], [1, 1], 9, Stop()).sets
    assert np.ptp(boxes.pieces[0], axis=0).tolist() == [1, 2, 3]
    assert [len(piece) for piece in pieces.pieces] == [8, 8]
    assert boxes.excess == pieces.excess == 0.0


def test_an_open_mesh_keeps_its_hull():
    mesh = VOLUMES[0].mesh
    (found,) = decompose_volumes([Solid(Mesh(mesh.vertices, mesh.triangles[1:]))], [1], 12, Stop()).sets
    assert len(found.pieces) == 1


def test_work_is_counted_and_the_same_in_every_run():
    first, second = (decompose_volumes(copied(VOLUMES), [1, 1, 1], 40, Stop()) for _ in range(2))
    assert first.work == second.work > 0.0
    for a, b in zip(first.sets, second.sets, strict=True):
        assert all(np.array_equal(p, q) for p, q in zip(a.pieces, b.pieces, strict=True))


def test_the_same_meshes_are_cut_once():
    volumes = copied(VOLUMES)
    first, second = (decompose_volumes(volumes, [1, 1, 1], 40, Stop()) for _ in range(2))
    assert first.work == second.work
    assert all(a is b for a, b in zip(first.sets[:2], second.sets[:2], strict=True))


def test_a_decomposition_that_was_stopped_is_not_kept():
    volumes = copied(VOLUMES)
    decompose_volumes(volumes, [1, 1, 1], 40, stop_after(9))
    again, fresh = (decompose_volumes(each, [1, 1, 1], 40, Stop()) for each in (volumes, copied(VOLUMES)))
    assert [len(each.pieces) for each in again.sets] == [len(each.pieces) for each in fresh.sets]
