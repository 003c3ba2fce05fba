"""Solids of meshes are made once."""

from tests.shared.solids import mesh_of
from tests.shared.supported import box

from amprep.checks.supports.solids import KnownSolids


def test_the_solid_of_a_mesh_is_made_once():
    solids, mesh = KnownSolids(), mesh_of(box((1, 2, 3), (0, 0, 0)))
    assert solids.of(mesh) is solids.of(mesh)
    assert abs(solids.of(mesh).volume() - 6.0) < 1e-9
    assert solids.of(mesh_of(box((1, 1, 1), (0, 0, 0)))) is not solids.of(mesh)
