"""Scenes for the tests of the annealing: small problems with shapes of one engine, and their searches."""

from dataclasses import replace

import numpy as np

from amprep.model import (
    Boxes,
    BuildVolume,
    ConvexPieces,
    Item,
    Orientations,
    PackingProblem,
    Placement,
    Solid,
)
from amprep.plugins.packers.annealing.params import AnnealingParams
from amprep.plugins.packers.annealing.scene import prepare_volumes
from amprep.plugins.packers.annealing.search import BuildSearch, BuildTask
from amprep.testing.problems import box_mesh

ENGINES = ("boxes", "trees", "pieces")


def l_shape(word, size):
    """Return an L of two boxes that touch, as the kind of volume of an engine."""
    x, y, z = size
    foot = np.zeros(3), np.array([x, y, z / 2])
    wall = np.array([0.0, 0.0, z / 2]), np.array([x / 2, y, z])
    if word == "boxes":
        return Boxes(np.array([foot[0], wall[0]]), np.array([foot[1], wall[1]]))
    if word == "pieces":
        return ConvexPieces((box_mesh(*foot), box_mesh(*wall)))
    from manifold3d import Manifold

    parts = [Manifold.cube(hi - lo).translate(lo) for lo, hi in (foot, wall)]
    mesh = (parts[0] + parts[1]).to_mesh64()
    from amprep.model import Mesh

    return Solid(Mesh(mesh.vert_properties[:, :3], mesh.tri_verts))


def shapes_problem(word, sizes, room=(12.0, 12.0, 30.0), *, orientations=None, space=None, **rules):
    """Return a problem of L shapes."""
    turns = orientations or Orientations()
    items = tuple(
        Item(n, 0, l_shape(word, np.array(size, float)), float(np.prod(size)), turns)
        for n, size in enumerate(sizes)
    )
    return PackingProblem(items, space or BuildVolume(np.array(room)), **rules)


def search_of(problem, layout=None, *, lowers=True, seed=1, engine="any", **params):
    """Return the search of one build, from the berths or from a layout ``{item: placement}``."""
    items = [n for n in range(len(problem.items)) if n not in {p.item for p in problem.fixed}]
    volume = np.array([problem.items[n].value for n in items])
    task = BuildTask(items, problem.fixed, layout or {}, volume, volume, lowers)
    chosen, rng = AnnealingParams(**params), np.random.default_rng(seed)
    return BuildSearch(prepare_volumes(problem, engine), task, chosen, rng)


def layout_of(search, problem):
    """Return the present poses of the movable bodies as placements, also of those outside."""
    return {
        item: Placement(item, pose.reshape(3, 4)[:, :3], pose.reshape(3, 4)[:, 3])
        for item, pose in zip(search.movable, search.state.pose, strict=False)
    }


def hall_around(problem):
    """Return the problem in so large a build volume that bodies outside are judged as well, for clearances only."""
    return replace(problem, space=BuildVolume(np.full(3, 1e6)), lift=-1e5)
