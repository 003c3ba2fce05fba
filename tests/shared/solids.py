"""Solids for tests, made with manifold3d: printable shapes, and random ones."""

import numpy as np
from manifold3d import CrossSection, Manifold, Mesh64, OpType

from amprep.model import Mesh, Solid


def arrays(solid):
    """Vertices and triangles of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, np.int64)


def mesh_of(solid):
    return Mesh(*arrays(solid))


def stacked(*solids):
    """Solids as shells of one mesh, not united."""
    meshes = [arrays(solid) for solid in solids]
    first = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    corners = [triangles + start for (_, triangles), start in zip(meshes, first, strict=False)]
    vertices = np.concatenate([each for each, _ in meshes])
    return Manifold(Mesh64(vertices, np.concatenate(corners).astype(np.uint64)))


def volume_of_solid(solid):
    """A solid of manifold3d as a bounding volume."""
    return Solid(mesh_of(solid))


def gear(teeth=20):
    """A gear with a bore."""
    angle = np.linspace(0, 2 * np.pi, 8 * teeth, endpoint=False)
    radius = 10 + np.tanh(3 * np.sin(teeth * angle))
    outline = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return CrossSection([outline]).extrude(5) - Manifold.cylinder(20, 3, 3, 48, True)


def thread(turns=4):
    """A screw thread: a triangle profile twisted along z, around a core."""
    profile = CrossSection.circle(4, 96) + CrossSection([np.array([[0, -2], [5.5, 0], [0, 2]], float)])
    return profile.extrude(2.0 * turns, 24 * turns, 360.0 * turns)


def gyroid(edge=1.0):
    """A block of gyroid with sheets on both sides."""

    def value(x, y, z):
        x, y, z = (np.pi * c / 4 for c in (x, y, z))
        return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)

    return Manifold.level_set(value, [-6, -6, -6, 6, 6, 6], edge, -0.2)


def thin_box(wall=0.1):
    """An open box with thin walls."""
    return Manifold.cube([30, 20, 10]) - Manifold.cube([30 - 2 * wall, 20 - 2 * wall, 10]).translate(
        [wall] * 3
    )


def nested_balls():
    """A ball in the cavity of another one: three shells."""
    return Manifold.sphere(10, 32) - Manifold.sphere(8, 32) + Manifold.sphere(5, 32)


def screw_plate():
    """A plate with rows of screw holes, narrow slots and rounded bosses."""
    holes = [
        Manifold.cylinder(9, 1.6, 1.6, 24).translate([5.0 + 9 * i, 5.0 + 9 * j, -1])
        for i in range(4)
        for j in range(3)
    ]
    slots = [Manifold.cube([0.2, 20, 9]).translate([9.4 + 9 * i, 3, 2]) for i in range(3)]
    bosses = [Manifold.sphere(3, 32).translate([5.0 + 9 * i, 28, 4]) for i in range(4)]
    plate = Manifold.batch_boolean([Manifold.cube([40, 30, 6]), *bosses], OpType.Add)
    return plate - Manifold.batch_boolean(holes + slots, OpType.Add)


PRINTABLE = {
    "gear": gear,
    "thread": thread,
    "gyroid": gyroid,
    "thin box": thin_box,
    "nested balls": nested_balls,
    "screw plate": screw_plate,
    "far away": lambda: screw_plate().translate([1e5, -2e5, 3e5]),
}
"""Name -> function that makes the solid."""


def random_solid(seed):
    """A random Boolean combination of turned cubes, balls and cylinders."""
    rng = np.random.default_rng(seed)
    solid = _random_shape(rng)
    for _ in range(rng.integers(1, 6)):
        other = _random_shape(rng)
        solid = solid - other if rng.random() < 0.4 else solid + other
    return solid if solid.volume() > 1.0 else Manifold.sphere(5, 24)


def _random_shape(rng):
    kind = rng.integers(3)
    if kind == 0:
        shape = Manifold.cube(rng.uniform(1, 8, 3).tolist(), True)
    elif kind == 1:
        shape = Manifold.sphere(rng.uniform(1, 4), int(rng.integers(8, 40)))
    else:
        shape = Manifold.cylinder(rng.uniform(1, 9), rng.uniform(0.5, 3), rng.uniform(0.5, 3), 24, True)
    turned = shape.rotate(rng.uniform(0, 360, 3).tolist()) if rng.random() < 0.5 else shape
    return turned.translate(rng.uniform(-4, 4, 3).tolist())
