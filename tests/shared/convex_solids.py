"""Made solids of kinds that a decomposition into convex pieces must handle."""

import numpy as np
from manifold3d import Manifold

from amprep.model import Mesh, Part


def _spiral():
    bars = [Manifold.cube([10, 2, 2]).translate([3, 0, k]).rotate([0, 0, 30 * k]) for k in range(8)]
    return Manifold.batch_boolean(bars, _union())


def _union():
    from manifold3d import OpType

    return OpType.Add


SOLIDS = {
    "cube": lambda: Manifold.cube([10, 20, 30]),
    "angle": lambda: Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20]),
    "turned angle": lambda: (Manifold.cube([20, 10, 5]) + Manifold.cube([5, 10, 20])).rotate([20, 30, 40]),
    "tee": lambda: Manifold.cube([30, 10, 5], True) + Manifold.cube([5, 10, 20], True).translate([0, 0, 10]),
    "ring": lambda: Manifold.cylinder(5, 20, 20) - Manifold.cylinder(5, 15, 15),
    "hollow": lambda: Manifold.cube([20, 20, 20]) - Manifold.cube([16, 16, 16]).translate([2, 2, 2]),
    "open box": lambda: Manifold.cube([20, 20, 20]) - Manifold.cube([18, 18, 20]).translate([1, 1, 1]),
    "ball in a box": lambda: (
        Manifold.cube([20, 20, 20], True) - Manifold.cube([16, 16, 16], True) + Manifold.sphere(5, 16)
    ),
    "thin": lambda: Manifold.cube([50, 50, 0.01]) + Manifold.cube([0.01, 50, 50]),
    "apart": lambda: Manifold.cube([5, 5, 5]) + Manifold.cube([5, 5, 5]).translate([50, 60, 70]),
    "drilled": lambda: Manifold.cube([20, 20, 5], True) - Manifold.cylinder(9, 5, 5, 40, True),
    "far away": lambda: (Manifold.sphere(3, 16) - Manifold.sphere(3, 16).translate([2, 0, 0])).translate(
        [-1000, 2000, 500]
    ),
    "spiral": _spiral,
}


def part_of(solid, name="part"):
    """Return a solid of manifold3d as a part."""
    mesh = solid.to_mesh64()
    return Part(name, Mesh(np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts)), solid.volume())
