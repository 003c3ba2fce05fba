"""Convex pieces contain the part with its interior, whatever the parameters and however early the end."""

import numpy as np
import pytest
from manifold3d import Manifold, OpType
from scipy.spatial import ConvexHull
from tests.shared.convex_solids import SOLIDS, part_of

from amprep.checks.volumes import check_volume
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model import Mesh, Part, Stop
from amprep.plugins.volumes.convex_decomposition import convex_pieces
from amprep.plugins.volumes.params import ConvexPiecesParams


def made(part, stop=None, **params):
    rng = np.random.default_rng(1)
    return convex_pieces(part, params=ConvexPiecesParams(**params), rng=rng, stop=stop or Stop())


def solids(volume):
    return [as_manifold(piece.vertices, piece.triangles) for piece in volume.pieces]


def union(volume):
    return Manifold.batch_boolean(solids(volume), OpType.Add)


@pytest.mark.parametrize("params", [{}, {"pieces": 1}, {"pieces": 3, "excess": 0.0}, {"method": "surface"}])
@pytest.mark.parametrize("name", SOLIDS)
def test_the_union_of_the_pieces_contains_the_solid_with_its_interior(name, params):
    solid = SOLIDS[name]()
    volume = made(part_of(solid), **params)
    assert (solid - union(volume)).is_empty()
    assert check_volume(part_of(solid), volume) == []
    assert 1 <= len(volume.pieces) <= params.get("pieces", 32)


@pytest.mark.parametrize("name", SOLIDS)
def test_the_pieces_are_closed_and_convex(name):
    for piece in made(part_of(SOLIDS[name]())).pieces:
        solid = as_manifold(piece.vertices, piece.triangles)
        assert accepted(solid)
        assert solid.volume() == pytest.approx(ConvexHull(piece.vertices).volume, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "pieces"), [("cube", 1), ("angle", 2), ("turned angle", 2), ("tee", 2), ("apart", 2)]
)
def test_a_polyhedral_part_gets_its_exact_pieces(name, pieces):
    solid = SOLIDS[name]()
    volume = made(part_of(solid))
    assert len(volume.pieces) == pieces
    assert union(volume).volume() == pytest.approx(solid.volume(), rel=1e-4)


def test_a_closed_cavity_is_filled():
    assert len(made(part_of(SOLIDS["hollow"]())).pieces) == 1


def test_more_pieces_fit_a_ring_better():
    solid = SOLIDS["ring"]()
    volumes = [union(made(part_of(solid), pieces=n, excess=0.0)).volume() for n in (1, 4, 12)]
    assert volumes[0] > volumes[1] > volumes[2] > solid.volume()
    assert volumes[2] < 1.08 * solid.volume()


def test_the_excess_saves_pieces():
    part = part_of(SOLIDS["ring"]())
    assert len(made(part, excess=0.2).pieces) < len(made(part, excess=0.02).pieces)


def test_parts_that_are_shallow_enough_are_not_cut():
    part = part_of(SOLIDS["drilled"]())
    assert len(made(part, concavity_mm=2.6).pieces) == 1
    assert len(made(part, concavity_mm=0.5).pieces) > 1


@pytest.mark.parametrize("checks", [0, 1, 5, 20])
def test_an_early_end_leaves_pieces_that_contain_the_part(checks):
    class Ended(Stop):
        calls = 0

        def __call__(self):
            Ended.calls += 1
            return Ended.calls > checks

    solid = SOLIDS["spiral"]()
    assert (solid - union(made(part_of(solid), stop=Ended()))).is_empty()


def test_the_same_part_gives_the_same_pieces():
    one, two = (made(part_of(SOLIDS["spiral"]())) for _ in range(2))
    assert [p.digest for p in one.pieces] == [p.digest for p in two.pieces]


@pytest.mark.parametrize("ended", [False, True])
def test_the_pieces_of_a_part_that_is_no_solid_contain_its_triangles(ended):
    mesh = part_of(SOLIDS["apart"]()).mesh
    surface = Part("surface", Mesh(mesh.vertices, mesh.triangles[:-3]), 1.0, is_solid=False)
    volume = made(surface, stop=Stop.after(0.0) if ended else None)
    assert (len(volume.pieces) > 1) != ended
    assert check_volume(surface, volume) == []


def test_a_stopped_decomposition_by_patches_gives_the_hulls_of_the_components():
    assert len(made(part_of(SOLIDS["apart"]()), stop=Stop.after(0.0), method="surface").pieces) == 2
