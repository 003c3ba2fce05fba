"""File size and time of writing a lattice of very many beams."""

import numpy as np
from tests.shared.optional import present

from amprep.model import Build, BuildSettings, BuildVolume, Lattice, Mesh, Part, PlacedPart, SupportBody
from amprep.threemf import read_build, write_build

STRUTS = 167_532


def block(count):
    """Return nodes and the first `count` struts of a block of body-centred cubic cells of 2 mm."""
    side = int(np.ceil(np.cbrt(count / 8)))
    cell = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)[:, ::-1]
    grid = np.stack(np.meshgrid(*[np.arange(side + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)[:, ::-1]
    corner = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    places = cell[:, None] + corner
    corners = (places * [1, side + 1, (side + 1) ** 2]).sum(axis=2)
    centres = np.repeat(len(grid) + np.arange(len(cell))[:, None], 8, axis=1)
    struts = np.stack([corners, centres], axis=2).reshape(-1, 2)[:count]
    return np.vstack([2.0 * grid, 2.0 * cell + 1.0]) + (10.1234, 10.1234, 0.0), struts


def test_167532_struts_take_at_most_1_mb_and_half_a_second(benchmark, tmp_path):
    import manifold3d

    nodes, struts = block(STRUTS)
    lo, hi = nodes.min(axis=0), nodes.max(axis=0)
    solid = manifold3d.Manifold.cube((hi - lo).tolist()).translate(lo.tolist()).to_mesh()
    box = Mesh(solid.vert_properties[:, :3], solid.tri_verts)
    space = BuildVolume((250.0, 250.0, 325.0))
    room = np.array([np.zeros(3), space.size])
    empty = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int32))
    lattice = Lattice(nodes, struts, np.full((len(struts), 2), 0.4), empty, box, room)
    part = PlacedPart("part", Part("part", box, box.signed_volume), np.eye(4))
    build = Build(
        BuildSettings("beams", space), (part,), (SupportBody("supports", box, (0,), lattice=lattice),)
    )
    path = tmp_path / "beams.3mf"
    benchmark.pedantic(lambda: write_build(build, path), rounds=3, warmup_rounds=1)
    assert path.stat().st_size <= 1_000_000
    if benchmark.stats is not None:
        assert benchmark.stats.stats.min <= 0.5
    assert len(present(read_build(path).supports[0].lattice).struts) == STRUTS
