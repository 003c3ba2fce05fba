"""Convex pieces of bounding volumes."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product, takewhile
from weakref import WeakKeyDictionary

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.prepared import extreme_points
from amprep.geometry.bounding.grid_cuts.decompose import SETS, CutSolid, cut_solid
from amprep.geometry.bounding.grid_cuts.distribute import distribute_pieces
from amprep.geometry.bounding.grid_cuts.enclose import enclosing_hull
from amprep.geometry.meshes.topology import edges_match
from amprep.geometry.no_fit.partition import MOST_FACES, exact_pieces, hull_volume
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

# Strategy. Boxes and convex pieces are taken as they are, and solids of few faces are decomposed exactly. All other
# solids get their hulls first. Then they are cut, the one with the greatest excess first: the volume of its hull
# outside the solid, times its copies. Each has now a decomposition for any number of pieces, and the number that all
# may have together is spent where a piece saves most volume. After a stop the solids that are not done keep hulls.

MOST_EXACT = 20
"""Number of exact pieces up to which a solid is packed exactly; work grows with the square of the number."""

GAIN_AN_ITEM, LEAST_GAIN, MOST_GAIN = 1e-5, 3e-4, 2e-3
"""Volume that another piece must save, as a fraction of the volume of its solid: for each item that is packed, and the
least and the greatest. Few items may have many pieces; for hundreds of items the programs would take too long."""

TRIANGLE_WORK, CUT_WORK, PIECE_WORK = 1_500, 700_000, 2_000_000
"""Work of a triangle, of a cut and of a piece of a solid, in field values read."""


THREADS = 2
"""Number of threads; most of the work is in kernels, which run side by side."""

TIME_TO_CUT = 0.6
"""Fraction of the time left that cutting may take; the rest is for the pieces."""


@dataclass(frozen=True, eq=False)
class PieceSet:
    """Convex pieces that contain a volume.

    Attributes
    ----------
    pieces
        For each piece its corners ``(k, 3)`` mm.
    excess
        Total volume of the pieces over that of the volume, less 1: what packing the pieces costs.
    """

    pieces: tuple[Floats, ...]
    excess: float


@dataclass(frozen=True, eq=False)
class Decomposition:
    """The pieces of some volumes, and the work (field values read) that they took."""

    sets: tuple[PieceSet, ...]
    work: float


def decompose_volumes(
    volumes: Sequence[BoundingVolume], copies: Sequence[int], total: int, stop: Stop
) -> Decomposition:
    """Decompose volumes into convex pieces that contain them; the ones whose pieces waste most are refined first.

    Parameters
    ----------
    volumes
        Bounding volumes.
    copies
        How often each is to be packed.
    total
        Number of pieces that all solids may have together; each has at least one.
    stop
        Asked between steps. After a stop each volume has at least its hull.
    """
    most = max(total // max(len(volumes), 1), 1)
    sets = [_first_pieces(volume, most, stop) for volume in volumes]
    meshes = {k: volume.mesh for k, volume in enumerate(volumes) if isinstance(volume, Solid)}
    work = float(sum(TRIANGLE_WORK * len(mesh.triangles) for mesh in meshes.values()))
    wasted = {k: sets[k].excess * mesh.signed_volume * copies[k] for k, mesh in meshes.items()}
    gain = float(np.clip(GAIN_AN_ITEM * sum(copies), LEAST_GAIN, MOST_GAIN))
    worst = sorted((k for k in wasted if sets[k].excess > gain), key=lambda k: (-wasted[k], k))
    left = total - sum(len(sets[k].pieces) for k in range(len(sets)) if k not in worst)
    number = _sets_to_cut(left, len(worst))
    cuts = _cut_each([meshes[k] for k in worst[: max(left - 1, 0)]], number, stop)
    work += CUT_WORK * sum(len(cut.hulls) for cut in cuts)
    counts = distribute_pieces(
        [cut.hulls for cut in cuts],
        [copies[k] for k in worst[: len(cuts)]],
        left * len(cuts) // max(len(worst), 1),
        [gain * cut.volume for cut in cuts],
    )
    work += PIECE_WORK * float(counts[counts > 1].sum())
    for k, pieces in zip(worst, _pieces_of_each(cuts, counts.tolist(), stop), strict=False):
        sets[k] = pieces or sets[k]
    return Decomposition(tuple(sets), work)


class _KnownCut:
    """The cuts of a mesh, and the pieces that were made of them; only these are kept after the decomposition."""

    def __init__(self, mesh: Mesh, number: int, stop: Stop) -> None:
        self.mesh, self.number = mesh, number
        self.cut: CutSolid | None = cut_solid(*mesh.arrays, stop, number)
        self.hulls, self.volume = self.cut.hulls, self.cut.volume
        self.made: dict[int, PieceSet] = {}

    def pieces(self, count: int, stop: Stop) -> PieceSet | None:
        """Return at most `count` pieces, made now or earlier; None after a stop, or for one piece."""
        if count < 2 or (count not in self.made and stop()):
            return None
        if count not in self.made:
            cut = self.cut or cut_solid(*self.mesh.arrays, stop, self.number)
            pieces = cut.pieces(count, stop)
            if pieces is None:
                return None
            self.made[count] = _piece_set(pieces, self.mesh.signed_volume)
        return self.made[count]


_KNOWN: "WeakKeyDictionary[Mesh, dict[int, _KnownCut]]" = WeakKeyDictionary()
"""Cuts by the number of sets, as long as the mesh is used: `auto` runs several packers on the same parts."""


def _cut_each(meshes: list[Mesh], number: int, stop: Stop) -> list[_KnownCut]:
    """Cut meshes in threads, the first ones if the time is not enough for all."""
    left = stop.remaining()
    early = stop.within(TIME_TO_CUT * left if np.isfinite(left) else None)

    def cut(mesh: Mesh) -> _KnownCut | None:
        known = _KNOWN.get(mesh, {}).get(number)
        if known is not None or early():
            return known
        found = _KnownCut(mesh, number, early)
        return found if early() else _KNOWN.setdefault(mesh, {}).setdefault(number, found)

    with ThreadPoolExecutor(THREADS) as pool:
        found = list(pool.map(cut, meshes))
    return [each for each in takewhile(lambda each: each is not None, found) if each is not None]


def _pieces_of_each(cuts: list[_KnownCut], counts: list[int], stop: Stop) -> list[PieceSet | None]:
    """Return the exact pieces of each cut, made in threads; None where there is one piece, and after a stop."""

    def pieces(known: _KnownCut, count: int) -> PieceSet | None:
        made = known.pieces(count, stop)
        known.cut = None
        return made

    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(pieces, cuts, counts))


def _sets_to_cut(total: int, solids: int) -> int:
    """Return into how many sets of cells a solid is cut: many more than it gets pieces."""
    return int(np.clip(4 * total // max(solids, 1), 24, SETS))


def _first_pieces(volume: BoundingVolume, most: int, stop: Stop) -> PieceSet:
    """Return the given or exact pieces of a volume, or its hull as the only piece."""
    found = _given_or_exact(volume, most, stop)
    if found is None and isinstance(volume, Solid):
        return _hull(volume)
    return found or PieceSet((), 0.0)


def _given_or_exact(volume: BoundingVolume, most: int, stop: Stop) -> PieceSet | None:
    """Return boxes, convex pieces, and the exact pieces of a solid of few faces, if they are not too many."""
    if isinstance(volume, Boxes):
        boxes = zip(volume.lo, volume.hi, strict=True)
        return PieceSet(tuple(np.array(list(product(*zip(lo, hi, strict=True)))) for lo, hi in boxes), 0.0)
    if isinstance(volume, ConvexPieces):
        return PieceSet(tuple(extreme_points(piece.vertices) for piece in volume.pieces), 0.0)
    if len(volume.mesh.triangles) > MOST_FACES:
        return None
    exact = exact_pieces(volume.mesh.vertices, volume.mesh.triangles, stop)
    return PieceSet(tuple(exact), 0.0) if exact is not None and len(exact) <= min(most, MOST_EXACT) else None


def _hull(volume: Solid) -> PieceSet:
    """Return the hull of a solid as its only piece; its excess is 0 if the solid cannot be cut."""
    mesh, hull = volume.mesh, enclosing_hull(volume.mesh.vertices)
    if mesh.signed_volume <= 0.0 or not edges_match(mesh.triangles):
        return PieceSet((hull,), 0.0)
    return _piece_set([hull], mesh.signed_volume)


def _piece_set(pieces: list[Floats], volume: float) -> PieceSet:
    return PieceSet(tuple(pieces), sum(map(hull_volume, pieces)) / volume - 1.0)
