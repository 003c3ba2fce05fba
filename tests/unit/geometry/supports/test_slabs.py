"""The pieces of slabs are those that manifold3d cuts out between the same planes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from tests.shared.examples import examples
from tests.shared.legs import least_width
from tests.shared.solids import arrays

from amprep.geometry.supports.slabs import pieces_of_slabs

FIRST, THICKNESS = -0.57, 1.0


def block(low, size):
    return Manifold.cube([float(s) for s in size]).translate([float(x) for x in low])


def slabs(solid):
    points, triangles = arrays(solid)
    return pieces_of_slabs(points, triangles, FIRST, THICKNESS)


def pieces_between_planes(solid, count):
    """The connected pieces of each slab, by cutting the solid."""
    found = []
    for slab in range(count):
        low = FIRST + slab * THICKNESS
        cut = solid.trim_by_plane((0, 0, 1), low).trim_by_plane((0, 0, -1), -(low + THICKNESS))
        found.append([] if cut.is_empty() else cut.decompose())
    return found


BLOCKS = st.tuples(
    st.tuples(st.integers(0, 8), st.integers(0, 8), st.integers(0, 6)),
    st.tuples(st.integers(1, 6), st.integers(1, 6), st.integers(1, 6)),
)


@given(st.lists(BLOCKS, min_size=1, max_size=8), st.lists(BLOCKS, max_size=4))
@examples(30)
def test_pieces_are_those_of_the_solid_cut_by_planes(added, removed):
    apart = [
        (np.array(low) + 0.013 * i, size) for i, (low, size) in enumerate(added)
    ]  # no faces in one plane
    solid = Manifold.batch_boolean([block(*each) for each in apart], OpType.Add)
    for low, size in removed:
        solid -= block(np.array(low) + 0.25, np.array(size) + 0.25)
    solid = Manifold.batch_boolean(
        [piece for piece in solid.decompose() if piece.volume() > 1e-6] or [block((0, 0, 0), (1, 1, 1))],
        OpType.Add,
    )
    found = slabs(solid)
    cut = pieces_between_planes(solid, 14)
    for slab, pieces in enumerate(cut):
        own = found.width[found.slab == slab]
        spanning = [piece for piece in pieces if touches_a_plane(piece, slab)]
        assert len(own) == len(spanning), slab
        exact = np.sort([least_width([piece.project()]) for piece in spanning])
        assert (np.sort(own) > exact * 0.999).all()
        assert (np.sort(own) < exact * 1.05).all(), "widths are found by a search over directions"


def touches_a_plane(piece, slab):
    """Whether a piece reaches the plane below or above it; the others are solids of their own."""
    low = FIRST + slab * THICKNESS
    box = piece.bounding_box()
    return box[2] < low + 1e-9 or box[5] > low + THICKNESS - 1e-9


def test_links_lead_from_a_fork_to_its_legs_and_tunnels_are_no_pieces():
    fork = block((0, 0, 0), (1, 1, 6)) + block((3, 0, 0), (1, 1, 6)) + block((0, 0, 6), (4, 1, 6))
    pipe = block((10, 0, 0), (4, 4, 12)) - block((11, 1, -1), (2, 2, 14))
    found = slabs(fork + pipe)
    pieces = np.bincount(found.slab)
    assert pieces.tolist() == [3] * 6 + [2] * 7
    at_fork = found.link[:, 0][np.bincount(found.link[:, 0])[found.link[:, 0]] == 2]
    assert len(set(at_fork.tolist())) == 1, "only the piece where both legs meet has two pieces below"
    assert len(found.link) == 5 * 3 + 3 + 6 * 2


def test_a_shell_of_a_void_belongs_to_no_piece():
    hollow = block((0, 0, 0), (4, 4, 12)) - block((1, 1, 1), (2, 2, 10))
    points, triangles = arrays(hollow)
    found = pieces_of_slabs(points, triangles, FIRST, THICKNESS)
    inner = ((points[:, :2] > 0.5) & (points[:, :2] < 3.5)).all(axis=1)
    assert np.bincount(found.slab).max() == 1
    assert (found.piece[~inner] >= 0).all()
