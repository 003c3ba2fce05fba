"""Small sample problems with every feature that a packer, router, volume maker or mesh reader may meet."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from amprep.arrays import Floats
from amprep.model import (
    BoundingVolume,
    Boxes,
    BuildVolume,
    ConvexPieces,
    Grid,
    Item,
    Mesh,
    Orientations,
    PackingProblem,
    Part,
    Placement,
    Solid,
    SupportProblem,
    Voxel,
)
from amprep.model.rotations import axis_rotations

_SIZES = ((30, 20, 10), (40, 40, 40), (25, 60, 15), (10, 10, 70), (55, 20, 20), (15, 15, 15))
_FACES = (
    *((0, 2, 3), (0, 3, 1), (4, 7, 6), (4, 5, 7), (0, 1, 5), (0, 5, 4)),
    *((2, 7, 3), (2, 6, 7), (0, 4, 6), (0, 6, 2), (1, 7, 5), (1, 3, 7)),
)


def box_mesh(lo: Floats, hi: Floats) -> Mesh:
    """Return a box with the corners `lo` and `hi`, ``(3,)`` mm each, as twelve triangles."""
    corners = [[x, y, z] for z in (lo[2], hi[2]) for y in (lo[1], hi[1]) for x in (lo[0], hi[0])]
    return Mesh(np.array(corners), np.array(_FACES))


def packing_problems() -> Iterator[tuple[str, PackingProblem]]:
    """Yield packing problems with their titles; each differs from the simplest problem in one respect."""
    plain = PackingProblem(_items("box"), BuildVolume(np.full(3, 100.0)), clearance=1.0, lift=2.0)
    tilted = Orientations("list", _turned_about_z(np.radians([30.0, 75.0])))
    for objective in ("builds", "fill", "height"):
        asked = replace(plain, objective=objective)
        yield f"{objective}", asked
        yield f"{objective}, parts beside each other", replace(asked, stacking=False)
        yield f"{objective}, no items", replace(asked, items=())
        yield f"{objective}, no clearance", replace(asked, clearance=0.0, lift=0.0)
        yield f"{objective}, several boxes an item", replace(asked, items=_items("boxes"))
        yield f"{objective}, convex pieces", replace(asked, items=_items("convex"))
        yield f"{objective}, solids", replace(asked, items=_items("solid"))
        for word, allowed in (
            ("one tilted orientation", Orientations("list", _turned_about_z(np.radians([30.0])))),
            ("turns from axis to axis", Orientations("list", axis_rotations())),
            ("listed orientations", tilted),
            ("any turn about z", Orientations("about-z")),
            ("any orientation", Orientations("free")),
        ):
            items = tuple(replace(item, orientations=allowed) for item in plain.items)
            yield f"{objective}, {word}", replace(asked, items=items)
        cylinder = BuildVolume(np.full(3, 100.0), "cylinder")
        yield f"{objective}, a cylinder", replace(asked, space=cylinder)
        zones = BuildVolume(np.full(3, 100.0), "box", np.array([[40.0, 40, 0]]), np.array([[60.0, 60, 100]]))
        yield f"{objective}, a forbidden zone", replace(asked, space=zones)
        fixed = (Placement(0, np.eye(3), np.array([50.0, 50, 2])),)
        yield f"{objective}, a fixed part", replace(asked, fixed=fixed)


def support_problems() -> Iterator[tuple[str, SupportProblem]]:
    """Yield support problems with their titles: a plate above an obstacle, on a grid of 6 x 9 x 9 voxels."""
    voxels = np.full((6, 9, 9), Voxel.FREE)
    voxels[5, 1:8, 1:8] = Voxel.OCCUPIED
    voxels[2, 3:6, 3:6] = Voxel.OCCUPIED
    plain = _support_problem(voxels)
    yield "nothing to support", _support_problem(np.full((3, 4, 4), Voxel.FREE))
    yield "a plate over an obstacle", plain
    yield "two paths an edge", replace(plain, edge_capacity=2)
    yield "three paths a square", replace(plain, node_capacity=3)
    narrow = voxels.copy()
    narrow[0] = Voxel.CLOSED
    narrow[0, 4, 0] = Voxel.FREE
    yield "a single way down, one path wide", replace(_support_problem(narrow), edge_capacity=1)
    bowl = voxels.copy()
    bowl[4, 1:8, 1:8] = Voxel.OCCUPIED
    bowl[4, 3:6, 3:6] = Voxel.FREE
    bowl[3, 2:7, 2:7] = Voxel.OCCUPIED
    yield "an enclosed hollow", _support_problem(bowl)


def sample_parts() -> list[Part]:
    """Return a box, a tetrahedron away from the origin, two separate boxes in two positions, and tilted boxes.

    Each has its bounding box. The tilted boxes allow several orientations.
    """
    box = box_mesh(np.zeros(3), np.array([10.0, 20, 30]))
    corner = Mesh(np.array([[5.0, 5, 5], [15, 5, 5], [5, 15, 5], [5, 5, 15]]), np.array(_TETRAHEDRON))
    far = box_mesh(np.array([40.0, 0, 0]), np.array([50.0, 5, 5]))
    high = box_mesh(np.array([0.0, 0, 70]), np.array([10.0, 20, 75]))
    named = (
        ("a box", box),
        ("a tetrahedron", corner),
        ("two boxes side by side", _both(box, far)),
        ("two boxes above each other", _both(box, high)),
    )
    parts = [Part(name, mesh, mesh.signed_volume, boxes=np.array([mesh.bounds])) for name, mesh in named]
    turned = Mesh(box.vertices @ _turned_about_z(np.radians([30.0]))[0].T, box.triangles)
    lists = Orientations("list", _turned_about_z(np.radians([0.0, 60.0])))
    free = (("listed orientations", lists), ("any turn about z", Orientations("about-z")))
    for word, allowed in (*free, ("any orientation", Orientations("free"))):
        bounds = np.array([turned.bounds])
        parts.append(
            Part(f"a tilted box, {word}", turned, turned.signed_volume, orientations=allowed, boxes=bounds)
        )
    return parts


def _both(first: Mesh, second: Mesh) -> Mesh:
    triangles = np.concatenate([first.triangles, second.triangles + len(first.vertices)])
    return Mesh(np.concatenate([first.vertices, second.vertices]), triangles)


_TETRAHEDRON = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def written_samples(folder: Path, suffixes: set[str]) -> list[Path]:
    """Write the tetrahedron in every common format among `suffixes` and return the paths."""
    import trimesh

    mesh = sample_parts()[1].mesh
    paths = [
        folder / f"sample{suffix}" for suffix in sorted(suffixes & {".stl", ".obj", ".ply", ".off", ".glb"})
    ]
    for path in paths:
        trimesh.Trimesh(mesh.vertices, mesh.triangles).export(path)
    return paths


def _items(word: str) -> tuple[Item, ...]:
    """Return two copies of the first size, one item of each other size, and one that is too large for a build."""
    sizes = [*_SIZES, (150, 20, 20)]
    volumes = [_volume(word, np.array(size, np.float64)) for size in sizes]
    parts = [Item(part, 0, volume, float(np.prod(sizes[part]))) for part, volume in enumerate(volumes)]
    return (parts[0], replace(parts[0], copy=1), *parts[1:])


def _volume(word: str, size: Floats) -> BoundingVolume:
    """Return a bounding volume away from the origin; several boxes or convex pieces form an L."""
    lo = np.array([-5.0, 3.0, 1.0])
    hi = lo + size
    knee = np.array([hi[0], hi[1], lo[2] + size[2] / 2]), np.array([lo[0] + size[0] / 2, hi[1], hi[2]])
    upper = np.array([lo[0], lo[1], lo[2] + size[2] / 2])
    if word == "boxes":
        return Boxes(np.array([lo, upper]), np.array(knee))
    if word == "convex":
        return ConvexPieces((box_mesh(lo, knee[0]), box_mesh(upper, knee[1])))
    return Solid(box_mesh(lo, hi)) if word == "solid" else Boxes(lo, hi)


def _turned_about_z(angles: Floats) -> Floats:
    zero, one = np.zeros_like(angles), np.ones_like(angles)
    rows = [np.cos(angles), -np.sin(angles), zero, np.sin(angles), np.cos(angles), zero, zero, zero, one]
    return np.stack(rows, axis=1).reshape(-1, 3, 3)


def _support_problem(voxels: np.ndarray) -> SupportProblem:
    """Return the problem with a red square under every occupied voxel above a free one."""
    occupied, free = voxels == Voxel.OCCUPIED, voxels == Voxel.FREE
    red = np.argwhere(occupied[1:] & free[:-1]) + np.array([1, 0, 0])
    zeros = np.zeros(len(red), np.int32)
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    return SupportProblem(grid, voxels, red, zeros, zeros, free[0])
