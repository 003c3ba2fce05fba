"""The judge of parts stays fast for hundreds of parts in contact: seconds of processor time, and how it judged."""

import time

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of

from amprep.checks.packing.parts_placed import judge_placed
from amprep.model import BuildSettings, BuildVolume, Orientations, Part, PlacedPart, Stop

LIMIT = 30.0
"""Seconds of processor time for 640 parts; about 5 are used."""


def tangled_part(rng, side):
    """Return a part of thousands of triangles in a cube of given side: a ball cut by balls, on a square base."""
    half = 0.5 * side
    solid = Manifold.sphere(half, int(rng.integers(24, 64))).translate([half, half, half])
    for _ in range(3):
        centre = rng.uniform(0.0, side, 3)
        solid -= Manifold.sphere(0.3 * side, 32).translate(centre.tolist())
    solid += Manifold.cube([side, side, 0.15 * side])
    return Part("part", mesh_of(solid), solid.volume())


def diagonal_grid(kinds, side, count):
    """Return parts face to face in a grid that is turned by 45 degrees, so that the enclosing boxes overlap."""
    c = np.sqrt(0.5)
    turn = np.array([[c, -c, 0.0], [c, c, 0.0], [0.0, 0.0, 1.0]])
    placed = []
    for number in range(count):
        matrix = np.eye(4)
        matrix[:3, :3] = turn
        matrix[:3, 3] = turn @ (side * np.array([number % 8, number // 8 % 8, number // 64])) + (80, 20, 0)
        placed.append(
            PlacedPart(f"part-{number}", kinds[number % len(kinds)], matrix, Orientations("about-z"))
        )
    return placed


@pytest.mark.parametrize("clearance", [0.0, 0.5])
def test_640_parts_in_contact_are_judged_in_seconds(clearance):
    rng = np.random.default_rng(2)
    placed = diagonal_grid([tangled_part(rng, 10.0) for _ in range(32)], 10.0, 640)
    space = BuildVolume(np.array([200.0, 200.0, 120.0]))
    settings = BuildSettings("bench", space, clearance=clearance)
    judge_placed(placed[:9], settings, Stop())  # compiles
    start = time.process_time()
    found, counts = judge_placed(placed, settings, Stop())
    spent = time.process_time() - start
    triangles = sum(len(each.part.mesh.triangles) for each in placed)
    print(f"{triangles} triangles, clearance {clearance}, {len(found)} violations, {counts}: {spent:.1f} s")
    assert spent < LIMIT
    assert bool(found) == (clearance > 0.0)
