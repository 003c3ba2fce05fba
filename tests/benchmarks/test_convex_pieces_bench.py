"""Convex decomposition of a bracket beside coacd and vhacdx, where these are installed, and queries of its pieces."""

import time

import numpy as np
import pytest
from manifold3d import Manifold, OpType
from tests.shared.convex import random_poses
from tests.shared.convex_solids import part_of

from amprep.geometry.bounding.convex.collision import pieces_collide, pieces_distance, pieces_travel
from amprep.geometry.bounding.convex.prepared import prepare_pieces
from amprep.model import Stop
from amprep.plugins.volumes.convex_decomposition import convex_pieces
from amprep.plugins.volumes.params import ConvexPiecesParams

POSES = 1000


def bracket():
    """A bracket with a boss, ribs and eight holes, some 3,000 triangles."""
    plates = Manifold.cube([60, 40, 4]) + Manifold.cube([4, 40, 40])
    ribs = [Manifold.cube([30, 3, 30]).rotate([0, 45, 0]).translate([-10, y, 20]) for y in (2, 35)]
    boss = Manifold.cylinder(15, 8, 6, 96).translate([40, 20, 0])
    solid = Manifold.batch_boolean([plates, boss, *ribs], OpType.Add)
    solid = solid.trim_by_plane([1, 0, 0], 0.0).trim_by_plane([0, 0, 1], 0.0)
    holes = [Manifold.cylinder(99, 2.2, 2.2, 64).translate([x, y, -1]) for x in (24, 55) for y in (8, 32)]
    bores = [
        Manifold.cylinder(99, 2.2, 2.2, 64).rotate([0, 90, 0]).translate([-1, y, z])
        for y in (12, 28)
        for z in (22, 34)
    ]
    bore = Manifold.cylinder(99, 4, 4, 96).translate([40, 20, -1])
    return solid - Manifold.batch_boolean([*holes, *bores, bore], OpType.Add)


def ours(part, **params):
    rng = np.random.default_rng(0)
    start = time.process_time()
    volume = convex_pieces(part, params=ConvexPiecesParams(**params), rng=rng, stop=Stop())
    return [piece.vertices for piece in volume.pieces], time.process_time() - start


def union(hulls):
    return Manifold.batch_boolean([Manifold.hull_points(np.array(hull)) for hull in hulls], OpType.Add)


def coacd_hulls(mesh):
    coacd = pytest.importorskip("coacd")
    coacd.set_log_level("error")
    return [hull for hull, _ in coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.triangles))]


def vhacd_hulls(mesh):
    vhacdx = pytest.importorskip("vhacdx")
    found = vhacdx.compute_vhacd(np.array(mesh.vertices), mesh.triangles.astype(np.uint32))
    return [hull for hull, _ in found]


def test_a_bracket_is_decomposed_within_a_few_percent(benchmark):
    solid = bracket()
    part = part_of(solid)
    ours(part)
    hulls, _ = benchmark.pedantic(lambda: ours(part), rounds=3)
    covered = union(hulls)
    benchmark.extra_info.update(pieces=len(hulls), ratio=covered.volume() / solid.volume())
    assert (solid - covered).is_empty()
    assert covered.volume() <= 1.05 * solid.volume()


@pytest.mark.parametrize("rival", [coacd_hulls, vhacd_hulls])
def test_no_other_decomposition_with_as_many_pieces_is_smaller_and_leaves_nothing_out(benchmark, rival):
    solid = bracket()
    part = part_of(solid)
    start = time.process_time()
    theirs = benchmark.pedantic(lambda: rival(part.mesh), rounds=1)
    their_seconds = time.process_time() - start
    ours(part)
    hulls, seconds = ours(part, pieces=len(theirs), excess=0.0)
    left_out = (solid - union(theirs)).volume() / solid.volume()
    ratio, their_ratio = (union(each).volume() / solid.volume() for each in (hulls, theirs))
    benchmark.extra_info.update(
        seconds=[seconds, their_seconds],
        ratio=[ratio, their_ratio],
        pieces=[len(hulls), len(theirs)],
        outside=left_out,
    )
    assert (solid - union(hulls)).is_empty()
    assert len(hulls) <= len(theirs)
    assert left_out > 0.01 or (ratio <= their_ratio and seconds <= their_seconds / 10)


@pytest.mark.parametrize("query", ["collide", "collide by programs", "distance", "travel"])
def test_queries_of_pieces(benchmark, query):
    pieces = prepare_pieces(ours(part_of(bracket()))[0])
    one, two = random_poses(1, POSES, 0.0), random_poses(2, POSES, 25.0)
    way = np.array([0.0, 0.0, 1.0])
    run = {
        "collide": lambda: pieces_collide(pieces, pieces, one, two),
        "collide by programs": lambda: pieces_collide(pieces, pieces, one[:20], two[:20], method="lp"),
        "distance": lambda: pieces_distance(pieces, pieces, one, two),
        "travel": lambda: pieces_travel(pieces, pieces, one, two, way, 0.5, 300.0),
    }[query]
    run()
    benchmark.pedantic(run, rounds=3)
    queries = 20 if "programs" in query else POSES
    benchmark.extra_info["microseconds"] = 1e6 * benchmark.stats.stats.min / queries
